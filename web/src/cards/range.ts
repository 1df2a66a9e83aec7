/* The range of colours that follows what is shown: upwards at once, downwards slowly, so that it does not
 * flicker, and never smaller than a floor: what an organ at rest has is rounding, and would fill the map. */

export interface Range {
    least: number;
    most: number;
}

const FLOORS: Record<string, number> = { m: 1e-4, Pa: 1, 'J/m³': 0.01 };
const SHRINK = 0.05; // per frame

export const floorOf = (unit: string): number => FLOORS[unit] ?? 0;

/* The range after one more frame, whose values go from `least` to `most`. `signed`: zero in the middle. */
export function follow(range: Range, least: number, most: number, unit: string, signed: boolean): Range {
    const size = Math.max(Math.abs(least), Math.abs(most), floorOf(unit));
    const low = signed ? -size : Math.min(0, least);
    const high = signed ? size : Math.max(most, floorOf(unit));
    return {
        least: low < range.least ? low : range.least + (low - range.least) * SHRINK,
        most: high > range.most ? high : range.most + (high - range.most) * SHRINK,
    };
}
