// SPDX-License-Identifier: MIT OR Apache-2.0
// Opens docs/report/index.html in headless Chromium: no errors, every chart draws its points, the player plays.
// Usage: node test.mjs [folder for screenshots]
import assert from "node:assert/strict";
import { existsSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import puppeteer from "puppeteer-core";

const page_path = join(dirname(fileURLToPath(import.meta.url)), "../../docs/report/index.html");
const executablePath = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find(existsSync);
assert(executablePath, "there is no Chromium: install the package chromium");
const browser = await puppeteer.launch({
  executablePath,
  // Pictures without a graphics card; root may start no sandbox.
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
});
let passed = 0;
async function check(name, work) {
  await work();
  passed += 1;
  console.log(`ok: ${name}`);
}

try {
  const page = await browser.newPage();
  await page.setViewport({ width: 1100, height: 900 });
  page.setDefaultTimeout(120_000); // for busy machines
  await page.setOfflineMode(true);
  const faults = [];
  page.on("console", (message) => {
    // Chromium itself warns where pictures are drawn without a graphics card.
    const isFault = ["error", "warn"].includes(message.type()) && !message.text().includes("GPU stall");
    if (isFault) faults.push(message.text());
  });
  page.on("pageerror", (error) => faults.push(error.message));
  page.on("requestfailed", (request) => faults.push(request.url()));
  await page.goto(pathToFileURL(page_path).href);
  await page.waitForFunction(() => window.measured && document.querySelector('[data-plot="figure8"] svg'));
  const data = await page.evaluate(() => window.measured);
  const count = (name) => page.$$eval(`[data-plot="${name}"] .points > *`, (marks) =>
    marks.filter((mark) => !mark.closest(".legend")).length);
  const folder = process.argv[2];
  const shootStage = async (name, frame) => {
    if (!folder) return;
    await page.$eval("#frame", (range, frame) => {
      range.value = frame;
      range.dispatchEvent(new Event("input"));
    }, frame);
    await (await page.$("#player")).screenshot({ path: join(folder, `demo_${name}.png`) });
  };
  /** Makes the page so wide, and waits until the last chart was drawn anew. */
  const widen = async (width) => {
    await page.setViewport({ width, height: 900 });
    await page.waitForFunction(() => {
      const drawn = document.querySelector('[data-plot="figure8"] figure > svg').getAttribute("width");
      return Number(drawn) === document.querySelector("#about").clientWidth;
    });
  };
  const questions = ["speed", "accuracy", "parting", "steps", "growth"];
  const isAbsent = (name) => page.$eval(`[data-plot="${name}"]`, (place) => place.textContent.includes("Not measured"));

  await check("the five questions have an answer, a chart and a link each, and the rest is behind a click", async () => {
    const sections = await page.$$eval("main > section[id]", (sections) => sections.slice(1).map((section) => ({
      id: section.id, answer: section.querySelector(".answer").textContent, plots: section.querySelectorAll(".plot").length,
      links: section.querySelectorAll('a[href^="../"]').length,
    })));
    assert.deepEqual(sections.map(({ id }) => id), questions);
    for (const { id, answer, plots, links } of sections) {
      assert(/\d/.test(answer) && !/undefined|NaN|Infinity/.test(answer), answer);
      assert(plots === 1 && links > 0 && (await count(id)) > 5, id);
    }
    const links = await page.$$eval('a[href^="../"]', (links) => links.map((link) => link.getAttribute("href").split("#")[0]));
    for (const link of links) assert(existsSync(join(dirname(page_path), link)), link);
    assert.equal(await page.$eval("#choose", (section) => section.checkVisibility()), false);
    await page.click("#all > summary");
    assert.equal(await page.$eval("#choose", (section) => section.checkVisibility()), true);
  });
  await check("at most six lines of a chart have a colour, each with a colour, a dash and a mark of its own", async () => {
    for (const name of ["steps", "growth", "bodies", "figure8"]) {
      const looks = await page.$$eval(`[data-plot="${name}"] figure > svg .lines`, (groups) => groups.map((group) => {
        const marks = group.nextElementSibling.querySelector("path, circle");
        return [group.getAttribute("stroke"), group.getAttribute("stroke-dasharray"), marks.getAttribute("d") ?? marks.tagName];
      }));
      const coloured = looks.filter(([stroke]) => stroke !== "var(--grey)");
      assert(coloured.length >= 2 && coloured.length <= 6, `${name}: ${coloured.length}`);
      for (const part of [0, 1, 2]) {
        assert.equal(new Set(coloured.map((look) => look[part])).size, coloured.length, `${name}: ${looks}`);
      }
    }
  });
  await check("labels of the five charts are whole and lie beside one another from 320 pixels up", async () => {
    for (const wide of [320, 768, 1400]) {
      await widen(wide);
      for (const name of questions) {
        const { cut, covered, texts } = await page.$eval(`[data-plot="${name}"]`, (place) => {
          const boxes = [...place.querySelectorAll("svg text, .legend span")].filter((text) => text.textContent).map((text) => {
            const [box, frame] = [text, text.closest("svg") ?? place].map((element) => element.getBoundingClientRect());
            const isAcross = box.left >= Math.max(frame.left, 0) && box.right <= Math.min(frame.right, innerWidth);
            return { text: text.textContent, box, isWhole: isAcross && box.top >= frame.top && box.bottom <= frame.bottom };
          });
          const overlap = (a, b) => a.left < b.right && b.left < a.right && a.top + 2 < b.bottom - 2 && b.top + 2 < a.bottom - 2;
          const covered = boxes.flatMap((a, i) => boxes.slice(i + 1).filter((b) => overlap(a.box, b.box)).map((b) => [a.text, b.text]));
          return { cut: boxes.filter(({ isWhole }) => !isWhole).map(({ text }) => text), covered, texts: boxes.length };
        });
        assert(texts > 8, `${name}: ${texts}`);
        assert.deepEqual({ cut, covered }, { cut: [], covered: [] }, `${name}, ${wide} pixels`);
      }
      assert.equal((await page.$$('[data-plot="accuracy"] .labels text')).length, await count("accuracy"), `${wide} pixels`);
    }
    await widen(1100);
  });
  await check("each scene's chart draws its points, for each error", async () => {
    const scenes = [...new Set(data.chart.map((row) => row.scene))];
    assert(scenes.length >= 6);
    const hidden = await page.$$eval("#variants input:not(:checked)", (boxes) => boxes.map((box) => (box.click(), box.id)));
    for (const scene of scenes) {
      await page.select("#scene", scene);
      for (const [measure, column] of [["force", "force_error"], ["missed", "recall"], ["direction", "direction_error"]]) {
        await page.select("#measure", measure);
        const wanted = data.chart.filter((row) => row.scene === scene && row[column] !== null).length;
        assert.equal(await count("choose"), wanted, `${scene}, ${measure}`);
      }
    }
    await page.select("#scene", scenes[0]);
    await page.select("#measure", "force");
    for (const id of hidden) await page.click(`#${id}`);
  });
  await check("labels of points of every setting lie beside one another, in the chart, and the front's are always there", async () => {
    for (const scene of [...new Set(data.chart.map((row) => row.scene))]) {
      await page.select("#scene", scene);
      const counts = [];
      for (const which of ["all", "front"]) {
        await page.select("#labels", which);
        const boxes = await page.$$eval('[data-plot="choose"] .labels text', (texts) => texts.map((text) => {
          const { left, right, top, bottom } = text.getBoundingClientRect();
          return { text: text.textContent, left, right, top: top + 2, bottom: bottom - 2 };
        }));
        const overlap = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
        const pairs = boxes.flatMap((a, i) => boxes.slice(i + 1).filter((b) => overlap(a, b)).map((b) => [a.text, b.text]));
        assert.deepEqual(pairs, [], scene);
        counts.push(boxes.length);
        assert(boxes.some(({ text }) => text.includes("(default)")), scene);
      }
      assert(counts[0] > counts[1] && counts[1] > 2, `${scene}: ${counts}`);
      await page.select("#labels", "all");
      assert.equal(await page.$eval("#unlabelled", (note) => note.textContent), "", scene);
    }
    await page.select("#scene", data.chart[0].scene);
  });
  await check("the stability maps draw their cells, or say that they were not measured", async () => {
    if (!data.stability) return assert(await isAbsent("stability"));
    assert.equal(data.stability.length, 2835);
    const [methods, steps] = ["method", "dt"].map((key) => new Set(data.stability.map((row) => row[key])).size);
    assert.equal(await count("stability"), methods * steps);
    for (const scene of new Set(data.stability.map((row) => row.scene))) {
      await page.select("#map-scene", scene);
      assert.equal(await count("stability"), data.stability.filter((row) => row.scene === scene).length, scene);
    }
    await page.select("#map-scene", "all");
  });
  const hostLabels = async (scene) => {
    await page.select("#host-scene", scene);
    const [names, inside] = await page.$$eval('[data-plot="hosts"] svg text', (texts) => {
      const isInside = (text) => {
        const [box, frame] = [text, text.closest("svg")].map((element) => element.getBoundingClientRect());
        return box.left >= frame.left && box.right <= frame.right;
      };
      return [texts.length, texts.filter(isInside).length];
    });
    assert.equal(inside, names, `${scene}: labels run out of the chart`);
  };
  const hostScenes = await page.$$eval("#host-scene option", (options) => options.map((option) => option.value));
  await check("each host's scene draws a labelled point for each run", async () => {
    for (const host of new Set(data.hosts.map((row) => row.host))) {
      assert(host === "own engine" || hostScenes.some((scene) => scene.startsWith(`${host}: `)), host);
    }
    let drawn = 0;
    for (const scene of hostScenes) {
      await hostLabels(scene);
      drawn += await count("hosts");
    }
    assert.equal(drawn, data.hosts.length);
    await page.focus("#host-scene");
    await page.keyboard.press("Home");
    assert.equal(await page.$eval("#host-scene", (select) => select.value), hostScenes[0]);
  });
  await check("the benchmark of deep contact ranks every library, in a table and in a chart", async () => {
    const libraries = new Set(data.deep.free.map((row) => row.library));
    const asked = new Set(data.deep.free.filter((row) => row.refused < row.poses).map((row) => row.library));
    assert.equal(await count("parting"), asked.size);
    const rows = await page.$$eval("#deep-table tr", (rows) => rows.slice(1).map((row) => row.cells[0].textContent));
    assert.deepEqual(new Set(rows), libraries);
    assert.equal(rows[0], "raycontact");
    const best = await page.$$eval("#deep-table .best", (cells) => cells.length);
    assert(best >= 6, `${best} best cells`);
  });
  await check("growth, threads and Figure 8 draw their points", async () => {
    for (const name of ["growth", "bodies", "parallel"]) assert((await count(name)) > 10, name);
    assert.equal(await count("figure8"), data.figure8.length);
  });
  await check("the table of failures is whole", async () => {
    const rows = await page.$$eval("#failure-table tr", (rows) => rows.length);
    assert.equal(rows, data.failures.rows.length + 1);
  });
  await check("a key press on the table gives the options as C code", async () => {
    await page.focus("#front button");
    await page.keyboard.press("Enter");
    await page.waitForFunction(() => document.getElementById("code").textContent.length > 0);
    const texts = await page.$$eval("#front button", (buttons) => buttons.map((button) => {
      button.click();
      return document.getElementById("code").textContent;
    }));
    assert(texts.some((text) => text.includes("rayc_default_detection_options")));
  });
  await check("a click on a point gives its options", async () => {
    await page.$eval("#code", (code) => (code.textContent = ""));
    const point = await page.$('[data-plot="choose"] .points > *');
    await point.scrollIntoView();
    const box = await point.boundingBox();
    await page.mouse.move(box.x + 2, box.y + 2);
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.down();
    await page.mouse.up();
    await page.waitForFunction(() => document.getElementById("code").textContent.length > 0);
    // Drawn anew, no point is held.
    await page.select("#labels", "front");
    await page.select("#labels", "all");
  });
  const demo = () => page.$eval("#stage", (stage) => ({ ...stage.dataset }));
  await check("the player opens each demo, at its first frame, and shows its contacts", async () => {
    assert(data.recordings.length >= 5);
    for (const { name } of data.recordings) {
      await page.select("#demo", name);
      await page.waitForFunction((name) => document.getElementById("stage").dataset.recording === name, {}, name);
      assert.equal((await demo()).frame, "0");
      const last = await page.$eval("#frame", (range) => Number(range.max));
      assert(last >= 40, `${name} has ${last + 1} frames`);
      let most = 0;
      await page.focus("#frame");
      for (let frame = 0; frame <= last; ++frame) {
        most = Math.max(most, Number((await demo()).contacts));
        await page.keyboard.press("ArrowRight");
      }
      // The paper's mode finds nothing on a body that is wholly inside.
      assert(name.endsWith("_paper") ? most === 0 : most > 10, `${name}: ${most} contacts`);
      await shootStage(name, Math.round(last / 4));
    }
    await page.select("#demo", data.recordings[0].name);
    await page.waitForFunction((name) => document.getElementById("stage").dataset.recording === name, {},
      data.recordings[0].name);
  });
  await check("the player plays, scrubs and turns by keys", async () => {
    await page.focus("#play");
    await page.keyboard.press("Enter");
    await page.waitForFunction(() => Number(document.getElementById("stage").dataset.frame) >= 3);
    await page.keyboard.press("Enter");
    await page.focus("#frame");
    await page.keyboard.press("Home");
    assert.equal((await demo()).frame, "0");
    assert(Number((await demo()).contacts) > 10);
    const shot = async () => (await (await page.$("#stage")).screenshot()).toString("base64");
    for (const [id, key] of [["stage canvas", "ArrowLeft"], ["stage canvas", "+"], ["wireframe", "Space"], ["lines", "Space"]]) {
      const before = await shot();
      await page.focus(`#${id}`);
      await page.keyboard.press(key);
      assert.notEqual(await shot(), before, `${key} on ${id}`);
    }
    for (const id of ["wireframe", "lines"]) await page.click(`#${id}`);
  });
  await page.select("#labels", "front");
  const shoot = async (name, height) => {
    if (!folder) return;
    await page.evaluate(() => document.activeElement.blur());
    const { width } = page.viewport();
    await page.screenshot({ path: join(folder, `${name}.png`), clip: { x: 0, y: 0, width, height } });
    await page.screenshot({ path: join(folder, `${name}_whole.png`), fullPage: true });
    await (await page.$("#deep")).screenshot({ path: join(folder, `${name}_deep.png`) });
    await (await page.$("#hosts")).screenshot({ path: join(folder, `${name}_hosts.png`) });
  };
  await shoot("report_light", 1700);
  /** How much lines stand out from the page: the least contrast of their colours, by the rule of WCAG 2. */
  const contrast = () => page.evaluate(() => {
    const light = (colour) => {
      const parts = colour.match(/[\d.]+/g).slice(0, 3).map((part) => part / 255);
      const [r, g, b] = parts.map((part) => (part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4));
      return 0.2126 * r + 0.7152 * g + 0.0722 * b + 0.05;
    };
    const back = light(getComputedStyle(document.body).backgroundColor);
    const lines = [...document.querySelectorAll(".lines")].map((line) => light(getComputedStyle(line).stroke));
    return Math.min(...lines.map((line) => Math.max(line, back) / Math.min(line, back)));
  });
  await check("dark and light differ, and lines stand out from both", async () => {
    assert((await contrast()) >= 3, "light");
    const colour = () => page.$eval("body", (body) => getComputedStyle(body).backgroundColor);
    const before = await colour();
    await page.focus("#theme");
    await page.keyboard.press("Enter");
    assert.notEqual(await colour(), before);
    assert((await contrast()) >= 3, "dark");
    await shoot("report_dark", 1700);
    await page.focus("#theme");
    await page.keyboard.press("Enter");
  });
  await check("on a narrow screen nothing runs out of the page, and charts are drawn anew", async () => {
    await widen(320);
    assert.deepEqual(await page.$$eval(".plot svg", (svgs) => svgs.filter((svg) => !svg.closest("#stability") &&
      svg.getBoundingClientRect().right > innerWidth).map((svg) => svg.closest(".plot").dataset.plot)), []);
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 320);
    assert((await count("choose")) > 50);
    for (const scene of hostScenes) await hostLabels(scene);
    await page.select("#host-scene", hostScenes[0]);
    await shoot("report_narrow", 1700);
  });
  await check("nothing was reported on the console or asked of the network", async () => assert.deepEqual(faults, []));
  console.log(`${passed} passed, 0 failed`);
} finally {
  await browser.close();
}
