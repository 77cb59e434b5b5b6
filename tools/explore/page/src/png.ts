/** Screenshots: PNG files that say what they show and which state of the page made them. */

const CRC_TABLE = makeCrcTable();

function makeCrcTable(): Uint32Array {
  const table = new Uint32Array(256);
  for (let n = 0; n < 256; n++) {
    let c = n;
    for (let bit = 0; bit < 8; bit++) c = c & 1 ? 0xedb88320 ^ (c >>> 1) : c >>> 1;
    table[n] = c >>> 0;
  }
  return table;
}

function computeCrc(bytes: Uint8Array): number {
  let c = 0xffffffff;
  for (const byte of bytes) c = CRC_TABLE[(c ^ byte) & 255] ^ (c >>> 8);
  return (c ^ 0xffffffff) >>> 0;
}

/** A tEXt chunk; characters outside Latin-1 become question marks. */
function makeTextChunk(keyword: string, text: string): Uint8Array<ArrayBuffer> {
  const content = `${keyword}\0${text}`;
  const chunk = new Uint8Array(content.length + 12);
  const view = new DataView(chunk.buffer);
  view.setUint32(0, content.length);
  const named = `tEXt${content}`;
  for (let i = 0; i < named.length; i++) {
    const code = named.charCodeAt(i);
    chunk[4 + i] = code < 256 ? code : 63;
  }
  view.setUint32(chunk.length - 4, computeCrc(chunk.subarray(4, chunk.length - 4)));
  return chunk;
}

/** Bytes of the PNG's signature and IHDR, which comes first. */
const HEAD = 33;

/** The PNG with a tEXt chunk for each entry. */
export function annotatePng(png: Uint8Array<ArrayBuffer>, texts: Record<string, string>): Blob {
  const chunks = Object.entries(texts).map(([keyword, text]) => makeTextChunk(keyword, text));
  return new Blob([png.slice(0, HEAD), ...chunks, png.slice(HEAD)], { type: "image/png" });
}

/** Offers the canvas's picture, on the page's ground, as a file to save. */
export async function savePicture(canvas: HTMLCanvasElement, name: string, texts: Record<string, string>): Promise<void> {
  const copy = document.createElement("canvas");
  copy.width = canvas.width;
  copy.height = canvas.height;
  const context = copy.getContext("2d")!;
  context.fillStyle = getComputedStyle(document.documentElement).getPropertyValue("--paper");
  context.fillRect(0, 0, copy.width, copy.height);
  context.drawImage(canvas, 0, 0);
  const blob = await new Promise<Blob | null>((done) => copy.toBlob(done, "image/png"));
  if (!blob) return;
  const annotated = annotatePng(new Uint8Array(await blob.arrayBuffer()), texts);
  const link = document.createElement("a");
  link.href = URL.createObjectURL(annotated);
  link.download = `merlkit-${name}.png`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
