/* Colours: of organs, of processors, of values.
 *
 * All are chosen in OKLab (Ottosson 2020), where equal distances look equally different. Organs differ in
 * lightness as well as in hue, so that people who confuse red and green still tell them apart. The
 * map for values runs from dark violet to light yellow with lightness rising evenly, in the manner
 * of the maps for perception that people know from plots; values around zero have a map of
 * their own, blue below, light in the middle, orange above.
 */

export type Rgb = [number, number, number]; // linear light, 0..1

/* Lightness, chroma and hue in degrees to linear light. */
export function oklch(l: number, c: number, h: number): Rgb {
    const angle = (h * Math.PI) / 180;
    return oklab(l, c * Math.cos(angle), c * Math.sin(angle));
}

function oklab(l: number, a: number, b: number): Rgb {
    const x = (l + 0.3963377774 * a + 0.2158037573 * b) ** 3;
    const y = (l - 0.1055613458 * a - 0.0638541728 * b) ** 3;
    const z = (l - 0.0894841775 * a - 1.291485548 * b) ** 3;
    return [
        clamp(4.0767416621 * x - 3.3077115913 * y + 0.2309699292 * z),
        clamp(-1.2684380046 * x + 2.6097574011 * y - 0.3413193965 * z),
        clamp(-0.0041960863 * x - 0.7034186147 * y + 1.707614701 * z),
    ];
}

const clamp = (v: number): number => Math.min(1, Math.max(0, v));
const encode = (v: number): number =>
    Math.round(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055));
export const css = (c: Rgb): string => `rgb(${encode(c[0])} ${encode(c[1])} ${encode(c[2])})`;

/* Tissue, where materials have no names in their order: muscle, pale tube, ivory, grey-pink, plum, ochre. */
const ORGANS: Rgb[] = [
    oklch(0.6, 0.135, 24),
    oklch(0.71, 0.09, 38),
    oklch(0.81, 0.05, 76),
    oklch(0.74, 0.035, 25),
    oklch(0.47, 0.075, 350),
    oklch(0.68, 0.085, 75),
    oklch(0.4, 0.09, 28),
    oklch(0.78, 0.03, 200),
];

/* Processors: hues that stay apart for all kinds of colour vision, lightness alternating. */
const PROCESSORS: Rgb[] = [
    oklch(0.7, 0.13, 245),
    oklch(0.82, 0.14, 85),
    oklch(0.55, 0.13, 30),
    oklch(0.75, 0.1, 165),
    oklch(0.5, 0.11, 290),
    oklch(0.88, 0.06, 110),
    oklch(0.62, 0.13, 350),
    oklch(0.45, 0.08, 220),
];

/* Organs that scenes often have, by what their names contain: the first that fits. */
const KNOWN: [RegExp, Rgb][] = [
    [/uter|muscle|myo/, ORGANS[0]!],
    [/tube|bowel|intestin|colon|gut/, ORGANS[1]!],
    [/ovar|bone|cortical/, ORGANS[2]!],
    [/ligament|tendon|fascia|connective/, ORGANS[3]!],
    [/liver|hepat/, oklch(0.46, 0.1, 32)],
    [/kidney|renal/, oklch(0.52, 0.1, 18)],
    [/spleen/, oklch(0.42, 0.08, 5)],
    [/heart|ventric|card/, oklch(0.55, 0.15, 26)],
    [/lung|pulmon/, oklch(0.76, 0.06, 15)],
    [/brain|cortex|white|grey|gray/, oklch(0.79, 0.045, 45)],
    [/arter|aort/, oklch(0.58, 0.17, 28)],
    [/vein|venous|cava|portal/, oklch(0.5, 0.09, 265)],
    [/gall|bile/, oklch(0.6, 0.1, 130)],
    [/fat|adipose/, oklch(0.85, 0.09, 92)],
    [/skin|derm/, oklch(0.8, 0.06, 55)],
    [/tumou?r|lesion|tumor/, oklch(0.72, 0.09, 100)],
    [/stomach|gastr/, oklch(0.7, 0.08, 20)],
    [/pancrea/, oklch(0.77, 0.08, 68)],
    [/bladder/, oklch(0.74, 0.07, 50)],
];

/* Of a name that nobody knows: some colour of tissue, always the same. */
function colourOfName(name: string): Rgb {
    let hash = 2166136261;
    for (const c of name) hash = Math.imul(hash ^ c.charCodeAt(0), 16777619) >>> 0;
    const share = (bits: number): number => ((hash >>> bits) & 0xff) / 255;
    return oklch(0.42 + 0.42 * share(0), 0.05 + 0.08 * share(8), 10 + 90 * share(16));
}

/* The colour of an organ is that of its name, the same in every scene; without a name, of its number. */
export function organColour(name: string, material: number): Rgb {
    const plain = name.toLowerCase().trim();
    if (!plain) return ORGANS[material % ORGANS.length]!;
    return KNOWN.find(([word]) => word.test(plain))?.[1] ?? colourOfName(plain);
}

export const processorColour = (p: number): Rgb => PROCESSORS[p % PROCESSORS.length]!;

export const STEPS = 256;
export type MapName = 'rising' | 'signed';

/* A map as STEPS colours in linear light, least value first. */
export function colourMap(name: MapName): Rgb[] {
    const points: [number, number, number][] =
        name === 'rising'
            ? [[0.33, 0.12, 300], [0.45, 0.12, 268], [0.55, 0.1, 230], [0.68, 0.11, 172], [0.81, 0.16, 130], [0.93, 0.17, 104]]
            : [[0.42, 0.14, 262], [0.62, 0.11, 245], [0.9, 0.015, 230], [0.66, 0.13, 55], [0.47, 0.14, 35]];
    const out: Rgb[] = [];
    for (let i = 0; i < STEPS; i++) {
        const t = (i / (STEPS - 1)) * (points.length - 1);
        const k = Math.min(points.length - 2, Math.floor(t));
        const [p, q] = [points[k]!, points[k + 1]!].map(([l, c, h]) => {
            const angle = (h * Math.PI) / 180;
            return [l, c * Math.cos(angle), c * Math.sin(angle)];
        }) as [number[], number[]];
        const f = t - k;
        const mixed = p.map((v, j) => v + (q[j]! - v) * f);
        out.push(oklab(mixed[0]!, mixed[1]!, mixed[2]!));
    }
    return out;
}
