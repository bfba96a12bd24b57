/** What the graphics processor does with a film: one triangle over the canvas, one texel for each of its pixels. */

export const vertexShader = `#version 300 es
void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  gl_Position = vec4(corner, 0.0, 1.0);
}`;

/** What a program paints: SHOW, a number of `shows` in look.ts; SIDE, 0 to 2; and whether there are marks over it. */
export interface Variant {
  show: number;
  side: number;
  marks: boolean;
}

/** A program for each variant: one with all branches takes five times as long, where the processor paints. */
export function fragmentShader({ show, side, marks }: Variant): string {
  return `#version 300 es\n#define SHOW ${show}\n#define SIDE ${side}\n#define MARKS ${Number(marks)}${fragmentBody}`;
}

/** Texels hold X, Y, Z and Y's standard error; those of `grid`, one for each tile, samples, invalid samples and the number of
 * who works on it. */
const fragmentBody = `
precision highp float;
precision highp sampler2D;
uniform sampler2D filmA, filmB, gridA, gridB, map;
uniform vec2 canvas, film, middle;
uniform vec4 chosen;
uniform float scale, exposure, wipe, tileSize, tileSizeB, meanY;
uniform int level, tone, warnings, overlay;
uniform vec2 range;
uniform bool logarithmic;
uniform mat3 display;
out vec4 colour;

const vec3 ground = vec3(0.03, 0.033, 0.045);

vec3 encode(vec3 linear) {
  vec3 c = clamp(linear, 0.0, 1.0);
  return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, vec3(greaterThan(c, vec3(0.0031308))));
}

// J. Hable, "Filmic Tonemapping for Real-time Rendering" (SIGGRAPH 2010), with its constants; white at 11.2.
vec3 hable(vec3 x) { return (x * (0.15 * x + 0.05) + 0.004) / (x * (0.15 * x + 0.5) + 0.06) - 0.02 / 0.3; }

vec3 curve(vec3 c, float y) {
  // Reinhard et al. 2002, equation 3, on luminance: colours keep their hue.
  if (tone == 1) return c / (1.0 + max(y, 0.0));
  if (tone == 2) return hable(2.0 * max(c, 0.0)) / hable(vec3(11.2)).x;
  return c;
}

float stripes() { return step(0.5, fract((gl_FragCoord.x + gl_FragCoord.y) / 8.0)); }

vec3 seen(vec4 texel) {
  vec3 exposed = exposure * (display * texel.xyz);
  vec3 toned = curve(exposed, exposure * texel.y);
  vec3 shown = encode(toned);
  float most = max(exposed.r, max(exposed.g, exposed.b));
  bool outside = min(exposed.r, min(exposed.g, exposed.b)) < -0.002 * most;
  bool over = max(toned.r, max(toned.g, toned.b)) > 1.0;
  if ((warnings & 2) != 0 && outside) shown = mix(shown, vec3(1.0, 0.0, 1.0), stripes());
  if ((warnings & 1) != 0 && over) shown = mix(shown, vec3(1.0, 0.1, 0.0), stripes());
  return shown;
}

vec3 mapped(float value) {
  float at = logarithmic ? log(value / range.x) / log(range.y / range.x) : (value - range.x) / (range.y - range.x);
  if (logarithmic && value <= 0.0) return ground;
  return texelFetch(map, ivec2(clamp(at, 0.0, 1.0) * 255.0 + 0.5, 0), 0).rgb;
}

vec3 one(vec4 texel, vec4 tile) {
#if SHOW == 0
  return seen(texel);
#else
  return mapped(float[](0.0, texel.y, texel.w, texel.w / max(sqrt(texel.y * texel.y + 0.01 * meanY * meanY), 1e-30), tile.x, tile.y, 0.0)[SHOW]);
#endif
}

// At reduced size, of means, in errors of single pixels.
vec3 difference(ivec2 texel) {
  vec4 a = texelFetch(filmA, texel, level);
  vec4 b = texelFetch(filmB, texel, level);
  return mapped((a.y - b.y) / max(sqrt(a.w * a.w + b.w * b.w), 1e-30));
}

void main() {
  vec2 at = (vec2(gl_FragCoord.x, canvas.y - gl_FragCoord.y) - 0.5 * canvas) / scale + middle;
  if (at.x < 0.0 || at.y < 0.0 || at.x >= film.x || at.y >= film.y) { colour = vec4(ground, 1.0); return; }
  ivec2 largest = max(ivec2(film) >> level, ivec2(1)) - 1;
  ivec2 texel = min(ivec2(at) >> level, largest);
  ivec2 place = ivec2(at / tileSize);
  vec4 tileA = texelFetch(gridA, place, 0);
  vec3 shown = ground;
#if SIDE > 0 || SHOW == 6
  vec4 tileB = texelFetch(gridB, ivec2(at / tileSizeB), 0);
#endif
#if SHOW == 6
  if (min(tileA.x, tileB.x) > 0.0) shown = difference(texel);
#else
#if SIDE != 1
  if (tileA.x > 0.0) shown = one(texelFetch(filmA, texel, level), tileA);
#endif
#if SIDE > 0
  if (SIDE == 1 || gl_FragCoord.x > wipe * canvas.x) shown = tileB.x > 0.0 ? one(texelFetch(filmB, texel, level), tileB) : ground;
#endif
#endif
#if MARKS == 1
  if (scale >= 12.0) {
    vec2 inside = fract(at) * scale;
    if (min(inside.x, inside.y) < 1.0) shown = mix(shown, vec3(0.5), 0.35);
  }
  if (overlay == 1 && tileA.z > 0.0) {
    vec2 inTile = (at / tileSize - vec2(place)) * tileSize * scale;
    vec2 tileEnd = min(vec2(tileSize), film - vec2(place) * tileSize) * scale;
    vec3 ink = 0.55 + 0.45 * cos(6.2832 * (0.382 * tileA.z + vec3(0.0, 0.33, 0.67)));
    vec2 edge = min(inTile, tileEnd - inTile);
    shown = min(edge.x, edge.y) < 2.0 ? ink : mix(shown, ink, 0.12);
  }
  vec2 low = (at - chosen.xy) * scale;
  vec2 high = (chosen.zw - at) * scale;
  float border = min(min(low.x, low.y), min(high.x, high.y));
  if (border > -2.0 && border < 0.0) shown = vec3(stripes());
#endif
  if (SIDE == 2 && SHOW != 6 && abs(gl_FragCoord.x - wipe * canvas.x) < 1.0) shown = vec3(1.0);
  colour = vec4(shown, 1.0);
}`;
