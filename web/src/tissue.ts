/* How wet tissue looks in the light of an endoscope (T 1.5.2): the light sits at the camera and does
 * not fall off with distance, so there are no shadows, and everything follows from one angle, that
 * between the surface and the line of sight:
 *
 *     cosine = normal . view    (light = view = half vector)
 *
 * Light that has gone into tissue comes out redder and rounds the edge of the dark; a film of
 * fluid, uneven at a fine scale, gives the highlights; grazing light is reflected. Mottling and
 * vessels are noise over the REST position, so they move and stretch with the tissue.
 */
import * as THREE from 'three';
import { STEPS, colourMap, type MapName } from './palette';

const VERTEX = /* glsl */ `
attribute vec3 rest;
attribute vec3 tint;
attribute float value;
attribute float open;
varying vec3 vView, vNormal, vRest, vTint;
varying float vValue, vOpen;
void main() {
    vec4 p = modelViewMatrix * vec4(position, 1.0);
    vView = p.xyz;
    vNormal = normalMatrix * normal;
    vRest = rest;
    vTint = tint;
    vValue = value;
    vOpen = open;
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
varying float vValue, vOpen;
uniform sampler2D map;
uniform vec2 range;     // least value, 1 / span
uniform float mapped;   // 0: tissue, 1: values by the map, 2: tints as they are
${NOISE}
void main() {
    vec3 view = normalize(-vView);
    vec3 normal = normalize(vNormal);
    if (!gl_FrontFacing) normal = -normal;

    vec4 broad = noise(vRest * 5.0);
    vec4 middle = noise(vRest * 14.0 + broad.xyz * 0.25);
    vec4 fine = noise(vRest * 52.0);
    float plain = min(mapped, 1.0);

    // An uneven film: bumps, turned with the body into the view, along the surface only.
    vec3 slope = normalMatrixOf * (middle.xyz * 0.10 + fine.xyz * 0.13);
    vec3 bumped = normalize(normal - (slope - normal * dot(slope, normal)) * mix(1.0, 0.25, plain));
    float smooth_ = clamp(dot(normal, view), 0.0, 1.0);
    float cosine = clamp(mix(dot(bumped, view), smooth_, 0.35), 0.0, 1.0);
    float film = clamp(dot(bumped, view), 0.0, 1.0);

    // Tissue: mottled, with vessels where a folded noise is near its ridge.
    float mottle = (broad.w - 0.5) * 0.5 + (middle.w - 0.5) * 0.35 + (fine.w - 0.5) * 0.2;
    vec3 colour = vTint * (1.0 + mottle * vec3(0.35, 0.62, 0.58));
    vec4 course = noise(vRest * 3.4 + middle.xyz * 0.10 + 7.0);
    float ridge = abs(course.w - 0.5) * 2.0 / (0.35 + length(course.xyz));
    float vessel = smoothstep(0.055, 0.0, ridge) * smoothstep(0.3, 0.6, broad.w);
    colour = mix(colour, colour * vec3(0.62, 0.30, 0.33), vessel * 0.6);

    vec3 shown = vTint;
    if (mapped > 0.5 && mapped < 1.5) {
        float t = clamp((vValue - range.x) * range.y, 0.0, 1.0);
        shown = texture2D(map, vec2((t * ${STEPS - 1}.0 + 0.5) / ${STEPS}.0, 0.5)).rgb;
        shown *= shown; // stored as square roots, which spends its 8 bits evenly
    }
    shown *= 1.0 + mottle * 0.10;
    colour = mix(colour, shown, plain);

    vec3 soft = mix(vec3(0.30, 0.11, 0.09), vec3(0.35), plain);
    vec3 lit = pow((vec3(cosine) + soft) / (1.0 + soft), mix(vec3(1.35), vec3(0.8), plain));
    float hollow = mix(1.0, vOpen, mix(1.0, 0.45, plain));
    lit *= mix(vec3(hollow * hollow, hollow * hollow * hollow, hollow * hollow * hollow), vec3(hollow), 0.35);

    // Highlights: a broad sheen and a sharp glint, both of the same film.
    float off = 1.0 - film * film;
    float sheen = 0.020 / pow(off + 0.050, 1.5) * 0.10;
    float glint = 0.00052 / pow(off * off + 0.0012, 1.0);
    float wet = smoothstep(0.25, 0.75, broad.w * 0.6 + middle.w * 0.4);
    float grazing = pow(1.0 - smooth_, 4.0);
    vec3 shine = vec3(1.0, 0.96, 0.92) * (sheen * 1.1 + glint * (0.5 + wet)) * hollow;
    shine += vec3(0.16, 0.075, 0.06) * grazing * hollow;
    shine *= mix(1.0, 0.22, plain);

    vec3 light = colour * lit * mix(1.25, 1.05, plain) + shine;
    // Bright places roll off instead of burning out.
    light = light / (1.0 + max(light - 0.6, 0.0) * 0.55);
    gl_FragColor = vec4(light, 1.0);
    #include <colorspace_fragment>
}`;

export class Tissue {
    readonly material: THREE.ShaderMaterial;
    private readonly maps: Record<MapName, THREE.DataTexture>;

    constructor() {
        this.maps = { rising: textureOf('rising'), signed: textureOf('signed') };
        this.material = new THREE.ShaderMaterial({
            vertexShader: VERTEX,
            fragmentShader: FRAGMENT.replace('varying vec3', 'uniform mat3 normalMatrixOf;\nvarying vec3'),
            uniforms: {
                map: { value: this.maps.rising },
                range: { value: new THREE.Vector2(0, 1) },
                mapped: { value: 0 },
                normalMatrixOf: { value: new THREE.Matrix3() },
            },
            side: THREE.DoubleSide,
            polygonOffset: true,
            polygonOffsetFactor: 1,
            polygonOffsetUnits: 1,
        });
    }

    showTissue(): void {
        this.material.uniforms.mapped!.value = 0;
    }

    showTints(): void {
        this.material.uniforms.mapped!.value = 2;
    }

    showValues(map: MapName, least: number, most: number): void {
        const uniforms = this.material.uniforms;
        uniforms.mapped!.value = 1;
        uniforms.map!.value = this.maps[map];
        uniforms.range!.value.set(least, most > least ? 1 / (most - least) : 0);
    }

    /* The bumps turn with the body: once a frame. */
    follow(camera: THREE.Camera): void {
        this.material.uniforms.normalMatrixOf!.value.setFromMatrix4(camera.matrixWorldInverse);
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
