/* Hard things in the light of the endoscope: instruments, arrows. Again only the angle between surface
 * and line of sight counts; polished steel mirrors a theatre
 * that is not there. */
import * as THREE from 'three';

const VERTEX = /* glsl */ `
varying vec3 vView, vNormal;
void main() {
    vec4 p = modelViewMatrix * vec4(position, 1.0);
    vView = p.xyz;
    vNormal = normalMatrix * normal;
    gl_Position = projectionMatrix * p;
}`;

const FRAGMENT = /* glsl */ `
varying vec3 vView, vNormal;
uniform vec3 colour;
uniform float polish, glow, alpha;
void main() {
    vec3 view = normalize(-vView);
    vec3 normal = normalize(vNormal);
    float cosine = clamp(dot(normal, view), 0.0, 1.0);
    // What it would mirror in a theatre: dark below, a bright ceiling, one lamp aside.
    vec3 mirror = reflect(-view, normal);
    float room = 0.20 + 0.55 * smoothstep(-0.5, 0.9, mirror.y);
    room += 0.55 * smoothstep(0.28, 0.0, abs(mirror.x - 0.45)) * smoothstep(-0.9, 0.3, mirror.y);
    float base = mix(0.25 + 0.75 * cosine, room * (0.35 + 0.65 * cosine), polish);
    float glint = polish * pow(cosine, 60.0) * 0.7;
    vec3 light = colour * mix(base, 1.0, glow) + vec3(glint) + polish * 0.10 * pow(1.0 - cosine, 3.0);
    gl_FragColor = vec4(light, alpha);
    #include <colorspace_fragment>
}`;

export interface Look {
    colour: readonly [number, number, number]; // linear light
    polish?: number; // 0 matt .. 1 polished steel
    glow?: number; // 1: as bright from all sides
    alpha?: number;
    onTop?: boolean; // also seen through what lies before it
}

export function instrumentMaterial(look: Look): THREE.ShaderMaterial {
    return new THREE.ShaderMaterial({
        vertexShader: VERTEX,
        fragmentShader: FRAGMENT,
        uniforms: {
            colour: { value: new THREE.Vector3(...look.colour) },
            polish: { value: look.polish ?? 0 },
            glow: { value: look.glow ?? 0 },
            alpha: { value: look.alpha ?? 1 },
        },
        transparent: look.onTop === true || (look.alpha ?? 1) < 1,
        depthTest: look.onTop !== true,
        depthWrite: look.onTop !== true,
    });
}
