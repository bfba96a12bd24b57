/** Paints films on a canvas with WebGL2, once per frame at most. */
import { displayMatrix } from "./colour.ts";
import { mapBytes, maps, mapSize } from "./colour_maps.ts";
import { GlImage } from "./gl_image.ts";
import { type Look, shows, tones } from "./look.ts";
import { levelFor, type Placement } from "./placement.ts";
import { fragmentShader, type Variant, vertexShader } from "./shaders.ts";

const names = [
  "canvas", "film", "middle", "chosen", "scale", "exposure", "wipe", "tileSize", "tileSizeB", "meanY",
  "level", "tone", "warnings", "overlay", "range", "logarithmic", "display",
] as const;

type Places = Record<(typeof names)[number], WebGLUniformLocation | null>;

export class GlPainter {
  readonly gl: WebGL2RenderingContext;
  first: GlImage | undefined;
  second: GlImage | undefined;
  readonly #programs = new Map<string, Program>();
  readonly #maps: Record<keyof typeof maps, WebGLTexture>;
  readonly #nothing: GlImage;

  /** Throws Error, fit to be shown, where there is no WebGL2. */
  constructor(canvas: HTMLCanvasElement) {
    const gl = canvas.getContext("webgl2", { alpha: false, antialias: false, preserveDrawingBuffer: true });
    if (!gl) throw new Error("This browser has no WebGL2, which the image needs. The preview can be downloaded as PNG.");
    this.gl = gl;
    gl.bindVertexArray(gl.createVertexArray());
    this.#maps = { viridis: mapTexture(gl, maps.viridis), diverging: mapTexture(gl, maps.diverging) };
    this.#nothing = new GlImage(gl, 1, 1, 1);
  }

  paint(look: Look, placement: Placement): void {
    const { gl } = this;
    const film = this.first ?? this.#nothing;
    const other = this.second ?? this.#nothing;
    gl.viewport(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight);
    [film.pixels, other.pixels, film.grid, other.grid, this.#maps[look.show === "difference" ? "diverging" : "viridis"]].forEach((made, unit) => {
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(gl.TEXTURE_2D, made);
    });
    const places = this.#use({
      show: shows.indexOf(look.show),
      side: this.second ? ["first", "second", "wipe"].indexOf(look.side) : 0,
      marks: look.workers || look.chosen !== undefined || placement.scale >= 12,
    });
    this.#place(places, film, placement);
    this.#show(places, look);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    // Uploads bind to the active unit.
    gl.activeTexture(gl.TEXTURE0);
  }

  #use(variant: Variant): Places {
    const { gl } = this;
    const key = JSON.stringify(variant);
    const known = this.#programs.get(key) ?? link(gl, variant);
    this.#programs.set(key, known);
    gl.useProgram(known.program);
    return known.places;
  }

  #place(places: Places, film: GlImage, placement: Placement): void {
    const { gl } = this;
    gl.uniform2f(places.canvas, gl.drawingBufferWidth, gl.drawingBufferHeight);
    gl.uniform2f(places.film, film.width, film.height);
    gl.uniform2f(places.middle, placement.x, placement.y);
    gl.uniform1f(places.scale, placement.scale);
    gl.uniform1f(places.tileSize, film.tileSize);
    gl.uniform1f(places.tileSizeB, (this.second ?? film).tileSize);
    const levels = this.second ? Math.min(film.levels, this.second.levels) : film.levels;
    gl.uniform1i(places.level, levelFor(placement.scale, levels));
  }

  #show(places: Places, look: Look): void {
    const { gl } = this;
    gl.uniform1i(places.tone, tones.indexOf(look.tone));
    gl.uniform1i(places.warnings, Number(look.warnClipped) + 2 * Number(look.warnGamut));
    gl.uniform1i(places.overlay, Number(look.workers));
    gl.uniform1f(places.wipe, look.wipe);
    gl.uniform1f(places.exposure, look.exposure);
    gl.uniform1f(places.meanY, look.measured.mean);
    gl.uniform2f(places.range, look.scale.low, look.scale.high);
    gl.uniform1i(places.logarithmic, Number(look.scale.logarithmic));
    gl.uniformMatrix3fv(places.display, true, displayMatrix(look.white).flat());
    const { x, y, width, height } = look.chosen ?? { x: -9, y: -9, width: 0, height: 0 };
    gl.uniform4f(places.chosen, x, y, x + width, y + height);
  }
}

interface Program {
  program: WebGLProgram;
  places: Places;
}

function link(gl: WebGL2RenderingContext, variant: Variant): Program {
  const program = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, vertexShader], [gl.FRAGMENT_SHADER, fragmentShader(variant)]] as const) {
    const shader = gl.createShader(kind);
    if (!shader) throw new Error("WebGL2 was lost");
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) {
    const said = gl.getAttachedShaders(program)?.map((shader) => gl.getShaderInfoLog(shader)).join(" ");
    throw new Error(`The image can't be shown: ${gl.getProgramInfoLog(program) ?? ""} ${said ?? ""}`);
  }
  gl.useProgram(program);
  ["filmA", "filmB", "gridA", "gridB", "map"].forEach((name, unit) => {
    gl.uniform1i(gl.getUniformLocation(program, name), unit);
  });
  return { program, places: Object.fromEntries(names.map((name) => [name, gl.getUniformLocation(program, name)])) as Places };
}

function mapTexture(gl: WebGL2RenderingContext, colours: readonly number[]): WebGLTexture {
  const made = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, made);
  gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA8, mapSize, 1);
  gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, mapSize, 1, gl.RGBA, gl.UNSIGNED_BYTE, mapBytes(colours));
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
  return made;
}
