/* Elements of the page, by id; numbers as people read them. */

export function element<T extends HTMLElement = HTMLElement>(id: string): T {
    const found = document.getElementById(id);
    if (!found) throw new Error(`the page has no element ${id}`);
    return found as T;
}

/* Writes only what differs: the page is not laid out anew for nothing. */
export function write(where: Element, text: string): void {
    if (where.textContent !== text) where.textContent = text;
}

const PREFIXES: [number, string][] = [
    [1e9, 'G'], [1e6, 'M'], [1e3, 'k'], [1, ''], [1e-3, 'm'], [1e-6, 'µ'], [1e-9, 'n'], [1e-12, 'p'],
];

/* Three digits and a unit: 1.25 kPa, 3.40 mm. */
export function withUnit(value: number, unit: string): string {
    if (unit === '') return String(Math.round(value));
    if (value === 0) return `0 ${unit}`;
    const size = Math.abs(value);
    const [factor, prefix] = PREFIXES.find(([f]) => size >= f * 0.9995) ?? PREFIXES[PREFIXES.length - 1]!;
    return `${digits(value / factor)} ${prefix}${unit}`;
}

function digits(value: number): string {
    const size = Math.abs(value);
    if (size < 0.005) return '0';
    return value.toFixed(size >= 100 ? 0 : size >= 10 ? 1 : 2).replace('-', '−');
}

/* One unit for numbers up to `largest`, small ones from a tenth of it on, with the places that three digits of the
 * largest take: numbers that change do not jump from unit to unit. */
export interface Scale {
    unit: string; // with its prefix
    factor: number; // of it
    text(value: number): string;
    short(value: number): string; // without zeros at its end: for axes
}

export function scaleFor(largest: number, unit: string): Scale {
    const size = largest > 0 ? largest : 1;
    const [factor, prefix] = PREFIXES.find(([f]) => size >= f * (f > 1 ? 0.9995 : 0.0995)) ?? PREFIXES[PREFIXES.length - 1]!;
    const places = Math.max(0, 2 - Math.floor(Math.log10(size / factor) + 1e-9));
    return {
        unit: prefix + unit,
        factor,
        text: (value) => (value / factor).toFixed(Math.min(20, places)).replace('-', '−'),
        short: (value) => String(Number((value / factor).toPrecision(2))),
    };
}

/* What people write: a comma is a decimal point, as in much of the world, where it can be nothing else. `1,250` may
 * be either, and is none. A field for numbers would decide by the browser's language, and make 15 of `1,5`. */
export function decimal(text: string): number {
    const plain = text.trim();
    const thousands = /^[+-]?[1-9]\d{0,2},\d{3}$/.test(plain);
    const written = /^[+-]?(\d+[.,]?\d*|[.,]\d+)(e[+-]?\d+)?$/i.test(plain) && !thousands;
    const value = written ? Number(plain.replace(',', '.')) : NaN;
    return Number.isFinite(value) ? value : NaN;
}

/* A number of the engine that may be missing. */
export function number(value: number | null | undefined, places: number): string {
    return value === null || value === undefined ? '–' : value.toFixed(places);
}
