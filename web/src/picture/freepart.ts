/* The part of the window that cards and bars leave free: where the organ is placed. Of all rectangles between
 * edges of what covers the window, the one whose shorter side is the longest. */

export interface Box {
    left: number;
    top: number;
    right: number;
    bottom: number;
}

const GAP = 6; // pixels beside what covers

export function freePart(width: number, height: number, covers: readonly Box[]): Box {
    const whole = { left: 0, top: 0, right: width, bottom: height };
    const xs = [0, width, ...covers.flatMap((box) => [box.left - GAP, box.right + GAP])].filter((x) => x >= 0 && x <= width);
    const ys = [0, height, ...covers.flatMap((box) => [box.top - GAP, box.bottom + GAP])].filter((y) => y >= 0 && y <= height);
    let best: Box | null = null;
    for (const left of xs)
        for (const right of xs)
            for (const top of ys)
                for (const bottom of ys) {
                    const box = { left, top, right, bottom };
                    if (right > left && bottom > top && isBetter(box, best) && !covers.some((cover) => overlap(box, cover))) best = box;
                }
    return best && sides(best)[0] >= SHORTEST ? best : whole;
}

const SHORTEST = 60; // pixels: in less than that nothing is seen; the organ lies behind the cards then

function sides(box: Box): [shorter: number, longer: number] {
    const [width, height] = [box.right - box.left, box.bottom - box.top];
    return [Math.min(width, height), Math.max(width, height)];
}

function isBetter(box: Box, than: Box | null): boolean {
    if (!than) return true;
    const [[short, long], [shortBefore, longBefore]] = [sides(box), sides(than)];
    return short > shortBefore || (short === shortBefore && long > longBefore);
}

const overlap = (a: Box, b: Box): boolean =>
    a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
