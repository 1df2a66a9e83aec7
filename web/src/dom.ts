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
    [1e6, 'M'], [1e3, 'k'], [1, ''], [1e-3, 'm'], [1e-6, 'µ'],
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

/* A number of the engine that may be missing. */
export function number(value: number | null | undefined, places: number): string {
    return value === null || value === undefined ? '–' : value.toFixed(places);
}
