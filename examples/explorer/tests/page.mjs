// Drives the built page in Chromium without a window, over its debugging pipe: opened as a file,
// every control moved, the texts and plots read. `node page.mjs CHROMIUM PAGE`; where a third
// argument names a folder, pictures of the page are left there.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [executable, file, pictures] = process.argv.slice(2);
const folder = mkdtempSync(join(tmpdir(), "explorer-"));
const flags = ["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-sync",
  "--disable-background-networking", "--disable-component-update", "--remote-debugging-pipe"];
const stdio = ["ignore", "ignore", "ignore", "pipe", "pipe"];
const browser = spawn(executable, [...flags, `--user-data-dir=${folder}`], { stdio });
const [waiting, complaints] = [new Map(), []];
let [last, rest, sessionId] = [0, ""];
browser.stdio[4].setEncoding("utf8").on("data", (text) => {
  const messages = (rest + text).split("\0");
  rest = messages.pop();
  for (const { id, result, error, method, params } of messages.map((one) => JSON.parse(one))) {
    if (id) waiting.get(id)(error ?? result);
    if (/exceptionThrown|entryAdded|consoleAPICalled/.test(method)) complaints.push(params);
  }
});
const send = (method, params = {}) => new Promise((answered) => {
  waiting.set(++last, answered);
  browser.stdio[3].write(JSON.stringify({ id: last, method, params, sessionId }) + "\0");
});
// The value of an expression in the page.
async function value(expression) {
  const options = { awaitPromise: true, returnByValue: true };
  const { result, exceptionDetails } = await send("Runtime.evaluate", { expression, ...options });
  assert.equal(exceptionDetails, undefined, JSON.stringify(exceptionDetails));
  return result.value;
}
const pause = (time) => new Promise((done) => setTimeout(done, time));
// Everything is computed and drawn.
async function settled() {
  for (let i = 0; i < 600; i++) {
    await pause(50);
    // While the browser goes to the page, there is no element yet.
    if (await value("document.documentElement?.dataset.state === 'ready'")) {
      const frame = "requestAnimationFrame";
      return value(`new Promise((drawn) => ${frame}(() => ${frame}(() => drawn())))`);
    }
  }
  assert.fail("the page computes for half a minute");
}
const text = (id) => value(`document.getElementById("${id}").innerText`);
const plot = (id) => value(`document.querySelector("#${id} svg").innerHTML`);
async function go(hash) {
  await value(`new Promise((changed) => {
    setTimeout(changed, 1000);
    addEventListener("hashchange", () => changed(), { once: true });
    location.hash = "${hash}"; })`);
  await settled();
}
async function type(name, content) {
  await value(`(() => { const field = document.querySelector("[name=${name}]");
    field.value = "${content}"; field.dispatchEvent(new Event("input", { bubbles: true })); })()`);
  await settled();
}
async function picture(name, width, height, scheme) {
  if (!pictures) return;
  const features = [{ name: "prefers-color-scheme", value: scheme }];
  await send("Emulation.setEmulatedMedia", { features });
  const size = { width, height, deviceScaleFactor: 1, mobile: false };
  await send("Emulation.setDeviceMetricsOverride", size);
  await pause(300);
  const { data } = await send("Page.captureScreenshot", { format: "png" });
  writeFileSync(join(pictures, `${name}.png`), Buffer.from(data, "base64"));
}

try {
  const { targetId } = await send("Target.createTarget", { url: "about:blank" });
  ({ sessionId } = await send("Target.attachToTarget", { targetId, flatten: true }));
  for (const domain of ["Page", "Runtime", "Log"]) await send(`${domain}.enable`);
  const size = { width: 1360, height: 900, deviceScaleFactor: 1, mobile: false };
  await send("Emulation.setDeviceMetricsOverride", size);
  await send("Page.navigate", { url: pathToFileURL(resolve(file)).href });
  await settled();

  // The paper's Fig. 5, to six digits.
  assert.match(await text("words"), /stable stick-slip: amplitude 0\.286209, period 6\.79942/);
  for (const mark of ["grazing 0.3958", "Hopf 0.4410"]) {
    assert.ok((await plot("diagram")).includes(mark));
  }
  await picture("light", 1360, 900, "light");

  // Every slider, by the keyboard, changes what is shown.
  const free = ["v_b", "beta", "load", "mu_s", "mu_k", "v_s", "u", "v", "time", "to"];
  const forced = ["force", "frequency", "v_b"];
  for (const [hash, names] of [["", free], ["law=stribeck", ["exponent", "viscous"]],
    ["force=0.2&v_b=0.3&beta=0.1", forced]]) {
    await go(hash);
    for (const name of names) {
      const shown = async () => {
        const plots = ["phase", "time", "diagram", "law"].map(plot);
        return [await text("words"), ...(await Promise.all(plots))];
      };
      const before = await shown();
      await value(`document.querySelector("[data-of=${name}]").focus()`);
      for (const kind of ["keyDown", "keyUp"]) {
        const key = { type: kind, key: "PageUp", code: "PageUp", windowsVirtualKeyCode: 33 };
        await send("Input.dispatchKeyEvent", key);
      }
      await settled();
      const after = await shown();
      const view = name === "time" || name === "to";
      assert.ok(after[0] !== before[0] || view, `${name}: the same words: ${after[0]}`);
      assert.ok(after.slice(1).some((one, i) => one !== before[i + 1]), `${name}: the same plots`);
      assert.equal(await text("error"), "", name);
    }
  }

  // A click in the phase plane is a start, a drag in the diagram moves the belt velocity.
  await go("");
  const at = async (id, right, down) => {
    const box = await value(`(({ x, y, width, height }) => ({ x, y, width, height }))(
      document.querySelector("#${id} svg").getBoundingClientRect())`);
    return { x: box.x + right * box.width, y: box.y + down * box.height, button: "left" };
  };
  const mouse = (type, place) =>
    send("Input.dispatchMouseEvent", { type, ...place, buttons: 1, clickCount: 1 });
  await mouse("mousePressed", await at("phase", 0.5, 0.5));
  await mouse("mouseReleased", await at("phase", 0.5, 0.5));
  await mouse("mousePressed", await at("diagram", 0.3, 0.5));
  for (const right of [0.4, 0.5, 0.6]) await mouse("mouseMoved", await at("diagram", right, 0.5));
  await mouse("mouseReleased", await at("diagram", 0.6, 0.5));
  await settled();
  const fields = await value("Object.fromEntries(new FormData(document.querySelector('form')))");
  assert.ok(fields.u > 0.1 && fields.u < 0.5 && fields.v_b > 0.3 && fields.v_b < 0.4, fields);

  // The address gives the same view again.
  const seen = async () => [await text("words"), await plot("phase"), await plot("diagram")];
  const [address, before] = [await value("location.hash"), await seen()];
  assert.ok(address.includes(`u=${fields.u}`) && address.includes(`v_b=${fields.v_b}`), address);
  await send("Page.navigate", { url: "about:blank" });
  await send("Page.navigate", { url: pathToFileURL(resolve(file)).href + address });
  await settled();
  assert.deepEqual(await seen(), before);

  // Bad numbers are answered in the words of the crate, and a good one heals all.
  await go("spring=1&normal_load=1&length=1");
  for (const [name, bad, good, message] of [
    ["beta", "-1", "0.05", "damping = -1 is not allowed"],
    ["load", "two", "1", "load = “two”: invalid float literal"],
    ["mass", "0", "", "Scaling: mass = 0 is not allowed"],
    ["to", "-1", "0.6", "range.end = -1 is not allowed"],
  ]) {
    await type(name, bad);
    assert.ok((await text("error")).includes(message), `${name}: ${await text("error")}`);
    await type(name, good);
    assert.equal(await text("error"), "", name);
  }

  // Basins; data and picture of a plot.
  await go("law=exponential&mu_s=0.6&mu_k=0.3&v_s=0.4&beta=0.01&v_b=1&to=4&u=1&basins=shown");
  assert.match(await text("words"), /also unstable pure slip: amplitude 0\.311236/);
  assert.ok((await plot("phase")).includes("<image"));
  const csv = await value("plots.diagram.csv()");
  assert.match(csv, /^series,v_b,"a"\n"Hopf",0\.00\d+,0/);
  assert.ok((await value("plots.phase.picture()")).startsWith("<svg xmlns="));
  await picture("dark", 1360, 900, "dark");
  await picture("narrow", 420, 900, "light");
  assert.deepEqual(complaints, []);
  console.log("the page does what it should");
} finally {
  await Promise.race([send("Browser.close"), pause(5000)]);
  browser.kill();
  await pause(200);
  rmSync(folder, { recursive: true, force: true, maxRetries: 5 });
}
