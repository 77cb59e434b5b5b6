// Opens the page of `merlkit explore` with an anisotropic material and a mesh, drops files on it, drags with fingers and zooms, and
// prints what it found as JSON: `faults` as sentences, and numbers that the caller compares.
//
// node explore_shapes.js CHROMIUM ADDRESS FOLDER   reads FOLDER/felt.bsdf and FOLDER/dropped.obj and writes FOLDER/NAME.png; needs
// playwright-core on NODE_PATH
const { chromium } = require("playwright-core");
const { readFileSync, writeFileSync } = require("node:fs");

const PATIENCE = 120_000;

async function main([executablePath, address, folder]) {
  const browser = await chromium.launch({ executablePath, args: ["--no-sandbox", "--disable-background-networking"] });
  const context = await browser.newContext({ viewport: { width: 390, height: 900 }, permissions: [], hasTouch: true });
  const tab = await context.newPage();
  tab.setDefaultTimeout(PATIENCE);
  const faults = [];
  tab.on("console", (message) => {
    if (message.type() === "error") faults.push(`the console says ${message.text()}`);
  });
  tab.on("pageerror", (error) => faults.push(`an error is thrown: ${error}`));
  await tab.goto(`${address}&material=ward%3Asx%3D0.1%2Csy%3D0.3&shape=sphere`);
  await tab.waitForSelector("#environment");
  const found = { faults, brushed: await keepSphere(tab, `${folder}/seen-brushed.png`) };
  // A sphere has one kind of normals.
  const normals = tab.locator("#sphere label", { hasText: "normals" });
  found.hidden = [await normals.isHidden()];
  found.slice = await readSlice(tab);
  await setState(tab, "shape=ball&normals=flat");
  found.mesh = await keepSphere(tab, `${folder}/seen-mesh.png`);
  found.hidden.push(await normals.isHidden());
  await setState(tab, "normals=smooth");
  found.smooth = await keepSphere(tab, `${folder}/seen-smooth.png`);
  await setState(tab, "light=studio");
  await tab.waitForFunction(() => Number(document.querySelector("#sphere canvas").dataset.samples) >= 8);
  found.skyCaption = await tab.locator("#sphere .caption").textContent();
  await setState(tab, "light=directional&shape=sphere");
  found.drops = await dropFiles(tab, folder);
  // The console says as well that the broken file was refused.
  const refused = faults.findIndex((fault) => fault.includes("400 (Bad Request)"));
  if (refused >= 0) faults.splice(refused, 1);
  found.touches = await touch(tab, context);
  found.zooms = await zoom(tab, context);
  await tab.screenshot({ path: `${folder}/shapes.png`, fullPage: true });
  await browser.close();
  console.log(JSON.stringify(found));
}

// What the address leaves out.
const DEFAULTS = { theta: "30", phi: "0", lightTheta: "45", lightPhi: "-35" };

// The members of the state in the address, once it has stayed the same for a while: the page writes it some time after a change.
async function readState(tab) {
  let before = "";
  for (;;) {
    await tab.waitForTimeout(600);
    const fragment = await tab.evaluate(() => location.hash.slice(1));
    if (fragment === before) return { ...DEFAULTS, ...Object.fromEntries(new URLSearchParams(fragment)) };
    before = fragment;
  }
}

// Changes members of the state by the address, as a link would.
async function setState(tab, members) {
  await tab.evaluate((text) => {
    const state = new URLSearchParams(location.hash.slice(1));
    for (const [name, value] of new URLSearchParams(text)) state.set(name, value);
    document.querySelector("#sphere canvas").dataset.samples = "";
    location.hash = state;
  }, members);
}

// The finished picture of the sphere, its size, its caption and the command that makes the same.
async function keepSphere(tab, path) {
  await tab.locator("#sphere").scrollIntoViewIfNeeded();
  await tab.waitForFunction(() => document.querySelector("#sphere canvas").dataset.samples === "32");
  const [size, url] = await tab.evaluate(() => {
    const canvas = document.querySelector("#sphere canvas");
    return [canvas.width, canvas.toDataURL("image/png")];
  });
  writeFileSync(path, Buffer.from(url.split(",")[1], "base64"));
  const button = tab.locator("#sphere header button").nth(1);
  await tab.waitForFunction(() => document.querySelectorAll("#sphere header button")[1].textContent === "Command");
  await button.click();
  await tab.waitForFunction(() => document.querySelectorAll("#sphere header button")[1].textContent !== "Command");
  return { size, command: await button.textContent(), caption: await tab.locator("#sphere .caption").textContent() };
}

// Colours of the image slice at the middle of some bins, by [theta_h, theta_d], and its caption.
async function readSlice(tab) {
  await setState(tab, "phiH=30&phiD=70");
  await tab.locator("#slice").scrollIntoViewIfNeeded();
  await tab.waitForFunction(() => document.querySelector("#slice .caption").textContent.includes("φh 30°"));
  return tab.evaluate(() => {
    const canvas = document.querySelector("#slice canvas");
    const scale = canvas.width / canvas.clientWidth;
    const [width, height] = [canvas.clientWidth, canvas.height / scale];
    const side = Math.min(width - 62, height - 66);
    const context = canvas.getContext("2d");
    const bins = [];
    // Between the lines of the grid, which are at multiples of 20.
    for (const [h, d] of [[5, 5], [25, 5], [33, 33], [45, 12], [5, 50], [50, 50], [87, 87]]) {
      const x = 48 + (side * (h + 0.5)) / 90;
      const y = 24 + side * (1 - (d + 0.5) / 90);
      const { data } = context.getImageData(Math.floor(x * scale), Math.floor(y * scale), 1, 1);
      bins.push({ h, d, rgb: [...data.slice(0, 3)] });
    }
    return { bins, caption: document.querySelector("#slice .caption").textContent };
  });
}

// Drops files on the page, as a file manager does, and says what the page then shows.
async function dropFiles(tab, folder) {
  const drops = {};
  for (const name of ["felt.bsdf", "dropped.obj", "broken.obj"]) {
    const bytes = name === "broken.obj" ? Buffer.from("f 1 2 3\n") : readFileSync(`${folder}/${name}`);
    const carried = await tab.evaluateHandle(
      ([file, text]) => {
        const data = Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
        const transfer = new DataTransfer();
        transfer.items.add(new File([data], file));
        return transfer;
      },
      [name, bytes.toString("base64")],
    );
    await tab.dispatchEvent("main", "dragover", { dataTransfer: carried });
    await tab.dispatchEvent("main", "drop", { dataTransfer: carried });
    await tab.waitForFunction((file) => {
      const said = document.getElementById("status").textContent;
      return said.startsWith("Loaded") || said.startsWith(`${file}:`);
    }, name);
    const said = await tab.locator("#status").textContent();
    const address = await tab.evaluate(() => new Promise((resolve) => setTimeout(() => resolve(location.hash), 400)));
    const state = new URLSearchParams(address.slice(1));
    drops[name] = { said, materials: state.getAll("material"), shape: state.get("shape") };
    await tab.evaluate(() => (document.getElementById("status").textContent = ""));
  }
  return drops;
}

// Waits until a panel has stayed where it is for a while: captions of panels above it change their height.
async function rest(tab, id) {
  let before = "";
  for (;;) {
    await tab.locator(`#${id} canvas`).scrollIntoViewIfNeeded();
    const place = JSON.stringify(await tab.locator(`#${id} canvas`).boundingBox());
    if (place === before) return;
    before = place;
    await tab.waitForTimeout(600);
  }
}

// Moves fingers over a canvas: `paths` has a path for each finger, in fractions of the canvas.
async function drag(tab, context, id, paths) {
  await rest(tab, id);
  const box = await tab.locator(`#${id} canvas`).boundingBox();
  const session = await context.newCDPSession(tab);
  function points(t) {
    return paths.map(([from, to], finger) => ({
      id: finger,
      x: box.x + box.width * (from[0] + t * (to[0] - from[0])),
      y: box.y + box.height * (from[1] + t * (to[1] - from[1])),
    }));
  }
  await session.send("Input.dispatchTouchEvent", { type: "touchStart", touchPoints: points(0) });
  for (let step = 1; step <= 8; step++) {
    await session.send("Input.dispatchTouchEvent", { type: "touchMove", touchPoints: points(step / 8) });
  }
  await session.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
  await session.detach();
}

// Drags the lobe's wo and the sphere's light by one finger; the page does not scroll meanwhile.
async function touch(tab, context) {
  await setState(tab, "theta=30&phi=0&lightTheta=45&lightPhi=-35&light=directional");
  const scrolls = [];
  const states = [await readState(tab)];
  for (const [id, path] of [["lobe", [[0.5, 0.5], [0.25, 0.7]]], ["sphere", [[0.4, 0.4], [0.7, 0.7]]]]) {
    await rest(tab, id);
    const before = await tab.evaluate(() => scrollY);
    await drag(tab, context, id, [path]);
    states.push(await readState(tab));
    scrolls.push((await tab.evaluate(() => scrollY)) - before);
  }
  return { states, scrolls };
}

// Zooms by two fingers, by the wheel and by keys, and shows all again.
async function zoom(tab, context) {
  const states = {};
  await drag(tab, context, "polar", [[[0.45, 0.5], [0.3, 0.5]], [[0.55, 0.5], [0.7, 0.5]]]);
  states.pinched = await readState(tab);
  states.caption = await tab.locator("#polar .caption").textContent();
  await tab.locator("#polar canvas").dblclick();
  states.reset = await readState(tab);
  const canvas = tab.locator("#cartesian canvas");
  await rest(tab, "cartesian");
  const box = await canvas.boundingBox();
  await tab.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await tab.mouse.wheel(0, -240);
  states.wheeled = await readState(tab);
  await canvas.press("+");
  states.pressed = await readState(tab);
  await canvas.press("ArrowRight");
  states.moved = await readState(tab);
  for (let i = 0; i < 8; i++) await canvas.press("-");
  states.shrunk = await readState(tab);
  const before = await tab.evaluate(() => scrollY);
  await tab.mouse.wheel(0, 100);
  await tab.waitForTimeout(300);
  states.scrolled = (await tab.evaluate(() => scrollY)) - before;
  return states;
}

main(process.argv.slice(2)).catch((error) => {
  console.error(error);
  process.exit(1);
});
