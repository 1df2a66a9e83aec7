/* The range of colours that follows what is shown: upwards at once, downwards slowly, so that it does not
 * flicker, and never smaller than a floor: what an organ at rest has is rounding, and would fill the map.
 * Floors of lengths and forces are in proportion to the body: one of 40 µm moves by µm, with nN. */
import { niceRange } from './graph';
import { sizeOfBody, type Hello } from '../link/protocol';

export interface Range {
    min: number;
    max: number;
}

const FLOORS: Record<string, number> = { Pa: 1, 'J/m³': 0.01 };
const LENGTH_PART = 2.5e-4; // of the body's size
const FORCE_PART = 5e-4; // of the softest shear modulus times the square of the size
const FORCE_MAX = 0.2; // N: what a hand feels; stiff bodies need no more to begin with
const SHRINK = 0.05; // per frame

export const floorOf = (unit: string, size: number): number =>
    unit === 'm' ? niceRange(LENGTH_PART * size, 0) : (FLOORS[unit] ?? 0);

export function forceFloor(hello: Pick<Hello, 'lower' | 'upper' | 'materials'>): number {
    const softest = Math.min(...hello.materials.map((material) => material.shear_modulus));
    const force = FORCE_PART * softest * sizeOfBody(hello) ** 2;
    return force > 0 && force < FORCE_MAX ? niceRange(force, 0) : FORCE_MAX;
}

/* The range after one more frame, whose values go from `min` to `max`. `signed`: zero in the middle. */
export function follow(range: Range, min: number, max: number, floor: number, signed: boolean): Range {
    const size = Math.max(Math.abs(min), Math.abs(max), floor);
    const low = signed ? -size : Math.min(0, min);
    const high = signed ? size : Math.max(max, floor);
    return {
        min: low < range.min ? low : range.min + (low - range.min) * SHRINK,
        max: high > range.max ? high : range.max + (high - range.max) * SHRINK,
    };
}
