/* How wet tissue looks in the light of an endoscope (T 1.5.2): the light sits at the camera and does
 * not fall off with distance, so almost everything follows from one angle, that between the surface
 * and the line of sight (shadows of instruments: shadows.ts):
 *
 *     cosine = normal . view    (light = view = half vector)
 *
 * Light that has gone into tissue comes out redder and rounds the edge of the dark; a film of
 * fluid, uneven at a fine scale, gives the highlights; grazing light is reflected. Mottling and
 * vessels are noise over the REST position, so they move and stretch with the tissue.
 */
import * as THREE from 'three';
import { SHADOWS, Shadows } from './shadows';
import { STEPS, colourMap, type MapName } from './palette';

const VERTEX = /* glsl */ `
attribute vec3 rest;
attribute vec3 tint;
attribute float value;
attribute vec4 tissueNoise;
varying vec3 vView, vNormal, vRest, vTint;
varying vec4 vTissueNoise;
varying float vValue;
#if defined(CUT) || defined(SHADOWS)
varying vec3 vPlace;
#endif
void main() {
#if defined(CUT) || defined(SHADOWS)
    vPlace = position;
#endif
    vec4 p = modelViewMatrix * vec4(position, 1.0);
    vView = p.xyz;
    vNormal = normalMatrix * normal;
    vRest = rest;
    vTint = tint;
    vValue = value;
    vTissueNoise = tissueNoise;
    gl_Position = projectionMatrix * p;
}`;

/* Value noise with its gradient: w is the value, xyz the slope; values and slopes are smooth. */
const NOISE = /* glsl */ `
float hash(vec3 p) {
    p = fract(p * 0.3183099 + vec3(0.71, 0.113, 0.419));
    p *= 17.0;
    return fract(p.x * p.y * p.z * (p.x + p.y + p.z));
}
vec4 noise(vec3 x) {
    vec3 i = floor(x), f = x - i;
    vec3 s = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    vec3 d = 30.0 * f * f * (f * (f - 2.0) + 1.0);
    float a = hash(i), b = hash(i + vec3(1, 0, 0)), c = hash(i + vec3(0, 1, 0)),
          e = hash(i + vec3(1, 1, 0)), g = hash(i + vec3(0, 0, 1)), h = hash(i + vec3(1, 0, 1)),
          k = hash(i + vec3(0, 1, 1)), l = hash(i + vec3(1, 1, 1));
    float xy = a - b - c + e, yz = a - c - g + k, zx = a - b - g + h;
    float all = -a + b + c - e + g - h - k + l;
    return vec4(
        d * vec3(b - a + xy * s.y + zx * s.z + all * s.y * s.z,
                 c - a + xy * s.x + yz * s.z + all * s.x * s.z,
                 g - a + zx * s.x + yz * s.y + all * s.x * s.y),
        a + (b - a) * s.x + (c - a) * s.y + (g - a) * s.z +
            xy * s.x * s.y + yz * s.y * s.z + zx * s.z * s.x + all * s.x * s.y * s.z);
}`;

const FRAGMENT = /* glsl */ `
varying vec3 vView, vNormal, vRest, vTint;
varying vec4 vTissueNoise;    // mottling, distances from two nets of vessels, openness: tissueNoise.ts
varying float vValue;
uniform mat3 turn;      // world to view
uniform sampler2D map;
uniform vec2 range;     // least value, 1 / span
uniform float mapped;   // 0: tissue, 1: values by the map, 2: tints as they are
#if defined(CUT) || defined(SHADOWS)
varying vec3 vPlace;
#endif
#ifdef CUT
uniform vec4 cut;       // what lies beyond this plane is not drawn: inspect/cut.ts
#endif
${NOISE}
#ifdef SHADOWS
${SHADOWS}
#endif
void main() {
#ifdef CUT
    float inside = cut.w - dot(cut.xyz, vPlace);
    if (inside < 0.0) discard;
#endif
    vec3 view = normalize(-vView);
    vec3 normal = normalize(vNormal);
    if (!gl_FrontFacing) normal = -normal;
    float plain = min(mapped, 1.0);
    float openness = vTissueNoise.w;

    // The film of fluid is uneven: bumps that are fixed to the tissue, along its surface.
    vec4 middle = noise(vRest * 11.0);
#ifdef FINE
    vec4 fine = noise(vRest * 38.0 + middle.w);
#else
    vec4 fine = vec4(0.0, 0.0, 0.0, 0.5);
#endif
    vec3 slope = turn * (middle.xyz * 0.135 + fine.xyz * 0.060);
    slope = (slope - normal * dot(slope, normal)) * mix(1.0, 0.2, plain);
    vec3 bumped = normalize(normal - slope);
    float smooth_ = clamp(dot(normal, view), 0.0, 1.0);
    float film = clamp(dot(bumped, view), 0.0, 1.0);
    float cosine = mix(film, smooth_, 0.4);

    // Tissue: paler and darker places, vessels.
    float mottle = vTissueNoise.x * 0.55 + (middle.w - 0.5) * 0.55 + (fine.w - 0.5) * 0.35;
    vec3 colour = vTint * exp(mottle * vec3(0.30, 0.62, 0.55));
    float trunk = smoothstep(0.020, 0.004, abs(vTissueNoise.y)) * smoothstep(-0.5, 0.4, vTissueNoise.x);
    float branch = smoothstep(0.011, 0.002, abs(vTissueNoise.z)) * smoothstep(0.25, -0.35, vTissueNoise.x);
    colour *= mix(vec3(1.0), vec3(0.60, 0.26, 0.34), trunk * 0.62);
    colour *= mix(vec3(1.0), vec3(0.78, 0.40, 0.42), branch * 0.55);

    vec3 shown = vTint;
    if (mapped > 0.5 && mapped < 1.5) {
        float t = clamp((vValue - range.x) * range.y, 0.0, 1.0);
        shown = texture2D(map, vec2((t * ${STEPS - 1}.0 + 0.5) / ${STEPS}.0, 0.5)).rgb;
        shown *= shown; // stored as square roots, which spends its 8 bits evenly
    }
    colour = mix(colour, shown * (1.0 + mottle * 0.10), plain);

    // Light that has been inside comes out red: green and blue fade sooner towards the rim.
    vec3 lit = pow(vec3(cosine * 0.93 + 0.07), mix(vec3(1.15, 1.95, 1.85), vec3(0.62), plain));
    lit *= mix(vec3(openness, openness * openness, openness * openness), vec3(0.55 + 0.45 * openness), plain);

    // Highlights of the film: a soft sheen, and glints with a hard edge where it is thick.
    float off = 1.0 - film;
    float wet = smoothstep(-0.5, 0.5, vTissueNoise.x + (middle.w - 0.5) * 0.8);
    float sheen = 0.11 * exp(-off * 18.0);
    float glint = (0.30 + 0.60 * wet) * smoothstep(0.0125, 0.0035, off);
#ifdef FINE
    // Drops and wrinkles of the film that stand up steeper.
    vec3 drops = turn * (middle.xyz * 0.30 + fine.xyz * 0.36);
    drops -= normal * dot(drops, normal);
    float drop = 1.0 - clamp(dot(normalize(normal - drops), view), 0.0, 1.0);
    glint += 0.42 * wet * smoothstep(0.012, 0.001, drop) * smoothstep(0.6, 0.8, smooth_);
#endif
    float grazing = (1.0 - smooth_) * (1.0 - smooth_);
    vec3 shine = vec3(1.0, 0.97, 0.95) * (sheen + glint) * openness;
    shine += vec3(0.13, 0.06, 0.05) * grazing * grazing * openness;
    shine *= mix(1.0, 0.16, plain);

    vec3 light = colour * lit * mix(1.36, 1.08, plain) + shine;
#ifdef SHADOWS
    // Colours that stand for values stay as they are.
    if (mapped < 0.5) light *= mix(vec3(0.30, 0.24, 0.25), vec3(1.0), lampReaches(vPlace));
#endif
    // Bright places roll off instead of burning out.
    light = min(light, 0.62) + 0.38 * (1.0 - exp(-max(light - 0.62, 0.0) / 0.38));
#ifdef CUT
    // What a cut lays open is the back of the surface: matt, and with a bright rim.
    if (!gl_FrontFacing) light = colour * lit * 0.55;
    if (inside < 1.5 * fwidth(inside)) light = vec3(0.85, 0.72, 0.55);
#endif
#ifdef FADED
    gl_FragColor = vec4(light, 0.14 + 0.5 * grazing);
#else
    gl_FragColor = vec4(light, 1.0);
#endif
    #include <colorspace_fragment>
}`;

export class Tissue {
    readonly material: THREE.ShaderMaterial;
    readonly shadows = new Shadows();
    readonly faded: THREE.ShaderMaterial; // the same, seen through
    private readonly maps: Record<MapName, THREE.DataTexture>;

    /* `fine`: also the finest bumps, which cost a third of the drawing. `cut`: Cut.plane. */
    constructor(fine: boolean, cut: THREE.Vector4) {
        this.maps = { rising: textureOf('rising'), signed: textureOf('signed') };
        this.material = new THREE.ShaderMaterial({
            vertexShader: VERTEX,
            fragmentShader: FRAGMENT,
            defines: fine ? { FINE: 1 } : {},
            uniforms: {
                map: { value: this.maps.rising },
                range: { value: new THREE.Vector2(0, 1) },
                mapped: { value: 0 },
                turn: { value: new THREE.Matrix3() },
                cut: { value: cut },
                ...this.shadows.uniforms,
            },
            side: THREE.DoubleSide,
            polygonOffset: true,
            polygonOffsetFactor: 1,
            polygonOffsetUnits: 1,
        });
        this.faded = this.material.clone();
        this.faded.uniforms = this.material.uniforms;
        this.faded.defines = { ...this.material.defines, FADED: 1 };
        this.faded.side = THREE.FrontSide;
        this.faded.transparent = true;
        this.faded.depthWrite = false;
    }

    showTissue(): void {
        this.material.uniforms.mapped!.value = 0;
    }

    showTints(): void {
        this.material.uniforms.mapped!.value = 2;
    }

    showValues(map: MapName, min: number, max: number): void {
        const uniforms = this.material.uniforms;
        uniforms.mapped!.value = 1;
        uniforms.map!.value = this.maps[map];
        uniforms.range!.value.set(min, max > min ? 1 / (max - min) : 0);
    }

    /* What is not needed is not in the shader: where the main processor draws it would cost a third. */
    use(cut: boolean, shadows: boolean): void {
        for (const material of [this.material, this.faded]) {
            const { defines } = material;
            if (('CUT' in defines) === cut && ('SHADOWS' in defines) === shadows) continue;
            for (const [name, wanted] of [['CUT', cut], ['SHADOWS', shadows]] as const)
                if (wanted) defines[name] = 1;
                else delete defines[name];
            material.needsUpdate = true;
        }
    }

    /* The bumps turn with the body: once a frame. */
    follow(camera: THREE.Camera): void {
        this.material.uniforms.turn!.value.setFromMatrix4(camera.matrixWorldInverse);
    }
}

function textureOf(name: MapName): THREE.DataTexture {
    const data = new Uint8Array(STEPS * 4);
    colourMap(name).forEach((c, i) => {
        for (let k = 0; k < 3; k++) data[i * 4 + k] = Math.round(255 * Math.sqrt(c[k]!));
        data[i * 4 + 3] = 255;
    });
    const texture = new THREE.DataTexture(data, STEPS, 1, THREE.RGBAFormat);
    texture.magFilter = texture.minFilter = THREE.LinearFilter;
    texture.needsUpdate = true;
    return texture;
}
