// Opens the page of `merlkit explore` in a headless Chromium, looks at every panel, reads values back from the canvases, and prints
// what it found as JSON: `faults` as sentences, and numbers that the caller compares with the library's.
//
// node explore.js CHROMIUM ADDRESS FOLDER   writes FOLDER/sphere.png and FOLDER/explore.png; needs playwright-core on NODE_PATH
const { chromium } = require("playwright-core");
const { readFileSync, writeFileSync } = require("node:fs");

const WIDTH = 390;
const PATIENCE = 120_000;
const PANELS = ["sphere", "lobe", "polar", "cartesian", "slice", "draws", "disc", "rows", "environment"];

async function main([executablePath, address, folder]) {
  const browser = await chromium.launch({ executablePath, args: ["--no-sandbox", "--disable-background-networking"] });
  const context = await browser.newContext({ viewport: { width: WIDTH, height: 900 }, permissions: [], acceptDownloads: true });
  const faults = [];
  const tab = await context.newPage();
  tab.setDefaultTimeout(PATIENCE);
  watch(tab, address, faults);
  const isStored = address.startsWith("file:");
  const state = isStored ? "#" : "&material=red-plastic&elevation=0&azimuth=0&sampler=cosine&rival=half-vector%3A64KB";
  const begun = Date.now();
  await tab.goto(address + state);
  await tab.waitForSelector("#environment");
  for (const id of PANELS) await look(tab, id, faults);
  const found = { seconds: (Date.now() - begun) / 1000, faults };
  const root = await tab.evaluate(() => [document.documentElement.scrollWidth, document.documentElement.clientWidth]);
  if (root[0] > root[1]) faults.push(`it scrolls sideways: ${root[0]} px wide`);
  found.size = await keepSphere(tab, `${folder}/sphere.png`);
  if (!isStored) {
    found.lobe = await compareLobe(tab, address);
    found.texts = await readScreenshot(tab);
    found.commands = await readCommands(tab);
    await showAnother(tab, "nickel");
    found.chiSquare = await testDraws(tab);
  }
  await tab.screenshot({ path: `${folder}/explore.png`, fullPage: true });
  await browser.close();
  console.log(JSON.stringify(found));
}

function watch(tab, address, faults) {
  const origin = address.replace(/[#?].*/, "");
  tab.on("console", (message) => {
    if (message.type() === "error") faults.push(`the console says ${message.text()}`);
  });
  tab.on("pageerror", (error) => faults.push(`an error is thrown: ${error}`));
  tab.on("request", (request) => {
    const isOwn = request.url().startsWith(origin) || /^(data|blob):/.test(request.url());
    if (!isOwn) faults.push(`it asks for ${request.url()}`);
  });
}

// Scrolls to a panel and waits until it is drawn; a panel is no single colour and says what it shows.
async function look(tab, id, faults) {
  const section = tab.locator(`#${id}`);
  await section.scrollIntoViewIfNeeded();
  await tab.waitForFunction((name) => {
    const panel = document.getElementById(name);
    return Number(panel.dataset.drawn) > 0 || panel.querySelector(".error");
  }, id);
  const isSphere = id === "sphere";
  if (isSphere) await tab.waitForFunction(() => document.querySelector("#sphere canvas").dataset.samples === "32");
  const [caption, isError, colours] = await section.evaluate((panel) => {
    const canvas = panel.querySelector("canvas");
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    const seen = new Set(new Uint32Array(data.buffer));
    const text = panel.querySelector(".caption");
    return [text.textContent, text.classList.contains("error"), seen.size];
  });
  if (isError || !caption) faults.push(`${id} says "${caption}"`);
  if (colours < 8) faults.push(`${id} has ${colours} colours`);
}

async function keepSphere(tab, path) {
  const [size, url] = await tab.evaluate(() => {
    const canvas = document.querySelector("#sphere canvas");
    return [canvas.width, canvas.toDataURL("image/png")];
  });
  writeFileSync(path, Buffer.from(url.split(",")[1], "base64"));
  return size;
}

// The arrays of a binary answer.
function parse(bytes) {
  const length = bytes.readUInt32LE(8);
  const { arrays } = JSON.parse(bytes.subarray(12, 12 + length).toString());
  const parsed = {};
  let offset = Math.ceil((12 + length) / 8) * 8;
  for (const { name, shape } of arrays) {
    const count = shape.reduce((a, b) => a * b, 1);
    parsed[name] = new Float32Array(new Uint8Array(bytes.subarray(offset, offset + 4 * count)).buffer);
    offset = Math.ceil((offset + 4 * count) / 8) * 8;
  }
  return parsed;
}

// Seen from the side, the left and right ends of the lobe on every line of pixels against those of the server's values; returns
// the largest difference in pixels and the number of lines.
async function compareLobe(tab, address) {
  const token = new URLSearchParams(new URL(address).hash.slice(1)).get("token");
  const key = "api/v1/lobe?material=0&theta=30&phi=0&rows=90&columns=180";
  const answer = await fetch(new URL(key, address), { headers: { "X-Merlkit-Token": token } });
  const { f } = parse(Buffer.from(await answer.arrayBuffer()));
  const rows = [];
  for (let row = 0; row < 90; row++) {
    const theta = ((row + 0.5) * Math.PI) / 180;
    const ring = [];
    for (let column = 0; column < 180; column++) {
      const i = 3 * (180 * row + column);
      const value = ((f[i] + f[i + 1] + f[i + 2]) / 3) * Math.cos(theta);
      // wo has the azimuth 0 and is on the left.
      ring.push([-value * Math.sin(theta) * Math.cos((column * Math.PI) / 90), value * Math.cos(theta), value]);
    }
    rows.push(ring);
  }
  const greatest = Math.max(...rows.flat().map((vertex) => vertex[2]));
  const image = await tab.evaluate(() => {
    const canvas = document.querySelector("#lobe canvas");
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    const blue = [];
    for (let i = 0; i < data.length; i += 4) blue.push(data[i + 2] > data[i] + 40);
    return { width: canvas.width, height: canvas.height, blue };
  });
  const unit = image.width / 2.5;
  const placed = rows.map((ring) => ring.map(([x, z]) => [image.width / 2 + (unit * x) / greatest, image.height / 2 - unit * (z / greatest - 0.5)]));
  let worst = 0;
  let lines = 0;
  for (let line = 0; line < image.height; line++) {
    const ends = crossLine(placed, line + 0.5);
    const run = image.blue.slice(line * image.width, (line + 1) * image.width);
    // Where the lobe is narrower than a few pixels, guides and smooth edges hide it.
    if (ends[1] - ends[0] < 6) continue;
    lines += 1;
    worst = Math.max(worst, Math.abs(run.indexOf(true) - ends[0]), Math.abs(run.lastIndexOf(true) + 1 - ends[1]));
  }
  return { worst, lines };
}

// Where edges of a mesh cross a horizontal line: the least and the greatest x.
function crossLine(rows, y) {
  const ends = [Infinity, -Infinity];
  for (let row = 0; row < rows.length; row++) {
    for (let column = 0; column < 180; column++) {
      const here = rows[row][column];
      const others = [rows[row][(column + 1) % 180], rows[row + 1]?.[column]];
      for (const other of others) {
        if (!other || here[1] > y === other[1] > y) continue;
        const x = here[0] + ((y - here[1]) / (other[1] - here[1])) * (other[0] - here[0]);
        ends[0] = Math.min(ends[0], x);
        ends[1] = Math.max(ends[1], x);
      }
    }
  }
  return ends;
}

// Counts the points of both discs in 48 cells of equal area. The cosine's draws are uniform there; returns chi-square of both discs.
async function testDraws(tab) {
  return tab.evaluate(() => {
    const canvas = document.querySelector("#draws canvas");
    const context = canvas.getContext("2d");
    const radius = Math.min(canvas.width / 4 - 10, 0.3 * canvas.height);
    const colours = [
      [0x00, 0x72, 0xb2],
      [0xd5, 0x5e, 0x00],
    ];
    return colours.map((colour, disc) => {
      const centre = [canvas.width * (0.25 + 0.5 * disc), radius + 26];
      const counts = new Array(48).fill(0);
      const { data } = context.getImageData(0, 0, canvas.width, Math.ceil(2 * radius + 40));
      for (let i = 0; i < data.length; i += 4) {
        if (!colour.every((c, k) => data[i + k] === c)) continue;
        const x = ((i / 4) % canvas.width) + 0.5 - centre[0];
        const y = Math.floor(i / 4 / canvas.width) + 0.5 - centre[1];
        const ring = Math.min(5, Math.floor(6 * (x * x + y * y) / (radius * radius)));
        const sector = Math.floor(((Math.atan2(y, x) / Math.PI + 1) * 4) % 8);
        counts[8 * ring + sector] += 1;
      }
      const total = counts.reduce((a, b) => a + b, 0);
      return { total, value: counts.reduce((sum, n) => sum + (n - total / 48) ** 2 / (total / 48), 0) };
    });
  });
}

// Another material by the address, as a link would.
async function showAnother(tab, name) {
  await tab.locator("#draws").scrollIntoViewIfNeeded();
  const before = await tab.locator("#draws").getAttribute("data-drawn");
  await tab.evaluate((material) => (location.hash = location.hash.replace(/material=[^&]*/, `material=${material}`)), name);
  await tab.waitForFunction((drawn) => document.getElementById("draws").dataset.drawn !== drawn, before);
}

// The texts in a screenshot that the page saves.
async function readScreenshot(tab) {
  const waiting = tab.waitForEvent("download");
  await tab.locator("#polar").getByRole("button", { name: "PNG" }).click();
  const bytes = readFileSync(await (await waiting).path());
  const texts = {};
  for (let at = 8; at < bytes.length; at += 12 + bytes.readUInt32BE(at)) {
    const length = bytes.readUInt32BE(at);
    if (bytes.toString("latin1", at + 4, at + 8) !== "tEXt") continue;
    const [keyword, text] = bytes.toString("latin1", at + 8, at + 8 + length).split("\0");
    texts[keyword] = text;
  }
  return texts;
}

// The commands of all panels. The clipboard is closed, so that each button shows its command.
async function readCommands(tab) {
  const commands = [];
  for (const id of PANELS) {
    const button = tab.locator(`#${id} header button`).nth(1);
    await button.click();
    await tab.waitForFunction((name) => /^(merlkit|Copied)/.test(document.querySelectorAll(`#${name} header button`)[1].textContent), id);
    commands.push(await button.textContent());
  }
  return commands;
}

main(process.argv.slice(2)).catch((error) => {
  console.error(error);
  process.exit(1);
});
