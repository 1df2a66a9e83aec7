/* The range of colours that follows what is shown: upwards at once, downwards slowly, so that it does not
 * flicker, and never smaller than a floor: what an organ at rest has is rounding, and would fill the map. */

export interface Range {
    min: number;
    max: number;
}

const FLOORS: Record<string, number> = { m: 1e-4, Pa: 1, 'J/m³': 0.01 };
const SHRINK = 0.05; // per frame

export const floorOf = (unit: string): number => FLOORS[unit] ?? 0;

/* The range after one more frame, whose values go from `min` to `max`. `signed`: zero in the middle. */
export function follow(range: Range, min: number, max: number, unit: string, signed: boolean): Range {
    const size = Math.max(Math.abs(min), Math.abs(max), floorOf(unit));
    const low = signed ? -size : Math.min(0, min);
    const high = signed ? size : Math.max(max, floorOf(unit));
    return {
        min: low < range.min ? low : range.min + (low - range.min) * SHRINK,
        max: high > range.max ? high : range.max + (high - range.max) * SHRINK,
    };
}
