// Opens a page in a headless Chromium at the widths of a phone, a laptop and a large screen, light and dark, and prints what is
// wrong with it as a JSON list of sentences.
//
// node inspect.js CHROMIUM PAGE FOLDER [WIDTH…]   writes FOLDER/WIDTH-SCHEME.png; needs playwright-core on NODE_PATH
const { chromium } = require("playwright-core");
const { pathToFileURL } = require("node:url");

const WIDTHS = [390, 1100, 1600];
const SCHEMES = ["light", "dark"];

async function main([executablePath, page, folder, ...widths]) {
  const browser = await chromium.launch({
    executablePath,
    args: ["--no-sandbox", "--disable-background-networking"],
  });
  const faults = [];
  for (const width of widths.length ? widths.map(Number) : WIDTHS) {
    for (const colorScheme of SCHEMES) {
      const context = await browser.newContext({ viewport: { width, height: 900 }, colorScheme });
      const found = await inspect(context, pathToFileURL(page).href, width);
      faults.push(...found.faults.map((fault) => `${width} px, ${colorScheme}: ${fault}`));
      await found.tab.screenshot({ path: `${folder}/${width}-${colorScheme}.png`, fullPage: true });
      await context.close();
    }
  }
  await browser.close();
  console.log(JSON.stringify(faults));
}

async function inspect(context, address, width) {
  const faults = [];
  const tab = await context.newPage();
  tab.on("console", (message) => {
    if (message.type() === "error") faults.push(`the console says ${message.text()}`);
  });
  tab.on("pageerror", (error) => faults.push(`an error is thrown: ${error}`));
  tab.on("request", (request) => {
    const isOwn = request.url() === address || request.url().startsWith("data:");
    if (!isOwn) faults.push(`it asks for ${request.url()}`);
  });
  await tab.goto(address);
  // What is folded away is judged as well.
  await tab.evaluate(() => document.querySelectorAll("details").forEach((part) => (part.open = true)));
  faults.push(...(await tab.evaluate(judge, width)));
  return { tab, faults };
}

// Runs in the page.
function judge(width) {
  const faults = [];

  // A sRGB colour's relative luminance (WCAG 2).
  function luminance([r, g, b]) {
    const linear = [r, g, b].map((c) => (c /= 255) <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
  }

  function channels(colour) {
    return colour.match(/[\d.]+/g).map(Number);
  }

  // The colour behind an element: in a chart that of its ground, elsewhere the nearest that is painted.
  function ground(element) {
    const chart = element.ownerSVGElement;
    if (chart) return channels(getComputedStyle(chart.closest("svg[role=img]").querySelector("rect")).fill);
    for (let e = element; e; e = e.parentElement) {
      const colour = channels(getComputedStyle(e).backgroundColor);
      if (colour.length === 3 || colour[3] > 0) return colour;
    }
    return [255, 255, 255];
  }

  const root = document.documentElement;
  if (root.scrollWidth > root.clientWidth) faults.push(`it scrolls sideways: ${root.scrollWidth} px wide`);

  const seen = new Set();
  const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (texts.nextNode()) {
    const element = texts.currentNode.parentElement;
    if (!texts.currentNode.data.trim() || seen.has(element)) continue;
    seen.add(element);
    if (["title", "desc", "style"].includes(element.localName)) continue;
    const words = `"${texts.currentNode.data.trim().slice(0, 40)}"`;
    const style = getComputedStyle(element);
    const scale = element.ownerSVGElement ? Math.hypot(element.getScreenCTM().a, element.getScreenCTM().b) : 1;
    const size = parseFloat(style.fontSize) * scale;
    if (width < 500 && size < 12) faults.push(`${words} has letters of ${size.toFixed(2)} px`);
    const ink = luminance(channels(element.ownerSVGElement ? style.fill : style.color));
    const paper = luminance(ground(element));
    const contrast = (Math.max(ink, paper) + 0.05) / (Math.min(ink, paper) + 0.05);
    if (contrast < 4.5) faults.push(`${words} has a contrast of ${contrast.toFixed(2)}`);
  }

  // The best cell differs from its neighbours by its ground, and a row keeps its name when its table is scrolled.
  const page = getComputedStyle(document.body).backgroundColor;
  for (const cell of document.querySelectorAll("td.best")) {
    const shade = getComputedStyle(cell).backgroundColor;
    if (shade === page || channels(shade)[3] === 0) faults.push(`"${cell.textContent}" is not shaded`);
  }
  // Names that are squeezed are broken between any two letters.
  for (const name of document.querySelectorAll("th[scope=row]")) {
    const across = name.getBoundingClientRect().width;
    if (across > 0 && across < 40) faults.push(`"${name.textContent}" is squeezed into ${across.toFixed(0)} px`);
  }
  for (const frame of document.querySelectorAll(".wide")) {
    frame.scrollLeft = frame.scrollWidth;
    const name = frame.querySelector("th[scope=row]");
    const offset = name ? name.getBoundingClientRect().left - frame.getBoundingClientRect().left : 0;
    if (Math.abs(offset) > 1) faults.push(`the name of a row moves by ${offset} px in "${frame.ariaLabel}"`);
    frame.scrollLeft = 0;
  }
  return faults;
}

main(process.argv.slice(2)).catch((error) => {
  console.error(error);
  process.exit(1);
});
