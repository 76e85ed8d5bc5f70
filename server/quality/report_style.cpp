#include "server/quality/report_page.h"

namespace tessera {

const char* const report_style = R"css(
:root {
  color-scheme: light dark;
  --ground: #f7f6f3; --card: #fff; --text: #211f1c; --quiet: #6c675f; --line: #dedad2; --accent: #1f6f8b;
  --good: #1b7f4b; --bad: #b3261e; --good-ground: #e2f3e9; --bad-ground: #fbe6e3; --shadow: 0 1px 2px #0001, 0 4px 16px #0000000d;
}
@media (prefers-color-scheme: dark) {
  :root {
    --ground: #151412; --card: #1f1d1a; --text: #ece8e1; --quiet: #a39c91; --line: #37332e; --accent: #74c0d8;
    --good: #6fd49e; --bad: #ff8a7d; --good-ground: #173325; --bad-ground: #47201c; --shadow: none;
  }
}
* { box-sizing: border-box; }
[hidden] { display: none !important; }
body { margin: 0; background: var(--ground); color: var(--text); font: 16px/1.5 system-ui, "Segoe UI", sans-serif; }
main { max-width: 1180px; margin: 0 auto; padding: 32px 24px 96px; }
h1 { font-size: 30px; line-height: 1.2; margin: 0 0 4px; overflow-wrap: anywhere; }
h2 { font-size: 20px; margin: 0 0 4px; }
h3 { font-size: 15px; margin: 20px 0 6px; }
p { margin: 0 0 14px; max-width: 78ch; color: var(--quiet); }
section { background: var(--card); border: 1px solid var(--line); border-radius: 12px; box-shadow: var(--shadow);
  padding: 22px 24px; margin-top: 20px; }
.facts { display: flex; flex-wrap: wrap; gap: 8px; margin: 14px 0 0; padding: 0; list-style: none; }
.facts li { border: 1px solid var(--line); border-radius: 99px; padding: 2px 12px; background: var(--card); font-size: 14px; }
.verdict { display: inline-block; font-weight: 600; border-radius: 99px; padding: 1px 12px; font-size: 14px; white-space: nowrap; }
.pass { color: var(--good); background: var(--good-ground); }
.fail { color: var(--bad); background: var(--bad-ground); }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; width: 100%; }
th, td { text-align: left; padding: 7px 14px 7px 0; border-bottom: 1px solid var(--line); }
tr:last-child > * { border-bottom: 0; }
th { font-weight: 500; font-size: 14px; color: var(--quiet); }
tbody th { color: var(--text); font-size: inherit; }
td.n, th.n { text-align: right; white-space: nowrap; }
.bar { position: relative; height: 10px; min-width: 160px; border-radius: 5px; background: var(--line); overflow: hidden; }
.bar i { position: absolute; inset: 0 auto 0 0; border-radius: 5px; background: var(--good); }
.bar.over i { background: var(--bad); }
.bar b { position: absolute; top: 0; bottom: 0; width: 2px; background: var(--text); left: 66.67%; }
.pair { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(320px, 100%), 1fr)); gap: 18px; }
[data-preview] + [data-preview] { margin-top: 18px; }
.charts { grid-template-columns: repeat(auto-fit, minmax(min(230px, 100%), 1fr)); }
figure { margin: 0; min-width: 0; }
figcaption { font-size: 14px; color: var(--quiet); margin-top: 6px; }
figcaption b { color: var(--text); font-weight: 600; }
.picture { display: block; width: 100%; padding: 0; background-color: transparent; border: 1px solid var(--line); border-radius: 8px; cursor: zoom-in; background-size: cover; background-origin: border-box; }
.picture:hover { border-color: var(--accent); }
.cells { image-rendering: pixelated; }
:focus-visible { outline: 3px solid var(--accent); outline-offset: 2px; }
.levels { display: flex; gap: 8px; margin: 0 0 12px; }
.levels button { font: inherit; font-size: 14px; color: inherit; background: none; border: 1px solid var(--line); border-radius: 99px; padding: 3px 14px; cursor: pointer; }
.levels button[aria-pressed=true] { background: var(--accent); border-color: var(--accent); color: var(--card); }
.scale { height: 10px; border-radius: 5px; margin-top: 8px; background: linear-gradient(90deg, #080614, #460f69, #a5235f, #e85a2d, #faaf32, #fcfab4); }
.ends { display: flex; justify-content: space-between; font-size: 13px; color: var(--quiet); }
.shifts { width: auto; font-size: 12px; }
.shifts td { padding: 0; border: 1px solid var(--card); width: 50px; height: 30px; text-align: center; border-radius: 4px; }
.shifts th { padding: 0 8px 0 0; border: 0; font-size: 12px; text-align: center; }
.contents { display: flex; flex-wrap: wrap; gap: 6px; }
.content { width: var(--side); padding: 0; border: 0; background: none; color: inherit; font: 11px/1.3 system-ui, sans-serif; cursor: zoom-in; text-align: center; }
.content i { display: block; width: var(--side); height: var(--side); border-radius: 5px; border: 2px solid transparent; background-origin: border-box; }
.content:hover i { border-color: var(--accent); }
.content.costly span { color: var(--bad); font-weight: 600; }
.content.dropped i { opacity: .3; }
.content.dropped span { text-decoration: line-through; }
.content.pinned i { border-color: var(--good); }
details > summary { cursor: pointer; font-weight: 600; padding: 4px 0; }
svg { width: 100%; height: 150px; display: block; }
svg .own { fill: var(--line); stroke: none; }
svg .made { fill: none; stroke: var(--accent); stroke-width: 2; vector-effect: non-scaling-stroke; }
dialog { width: 100vw; height: 100vh; max-width: none; max-height: none; margin: 0; padding: 0; border: 0; background: #0d0c0bf2; color: #f0ece5; overflow: hidden; }
dialog .stage { position: absolute; left: 0; top: 0; transform-origin: 0 0; cursor: grab; image-rendering: pixelated; touch-action: none; }
dialog .stage:active { cursor: grabbing; }
dialog header { position: absolute; inset: 0 0 auto; display: flex; gap: 16px; align-items: center; justify-content: space-between; padding: 8px 16px; background: #0d0c0bcc; font-size: 14px; z-index: 1; }
dialog header button { font: inherit; color: inherit; background: #ffffff1f; border: 0; border-radius: 99px; padding: 4px 14px; cursor: pointer; }
@media (max-width: 640px) { main { padding: 20px 12px 60px; } section { padding: 16px; } th, td { padding-right: 10px; } .bar { min-width: 60px; } }
@media print { .levels, dialog { display: none; } section { break-inside: avoid; } }
)css";

// Without it the page shows everything too, only not enlarged
const char* const report_script = R"js(
const dialog = document.querySelector('dialog'), stage = dialog.querySelector('.stage'), words = dialog.querySelector('[data-words]');
let width = 1, height = 1, scale = 1, left = 0, top_ = 0;
const place = () => { stage.style.transform = `translate(${left}px, ${top_}px) scale(${scale})`; };
const fit = (least) => {
  const room = [innerWidth, innerHeight - 44];
  scale = Math.min(room[0] / width, room[1] / height);
  if (least && scale < least) scale = least;
  left = (innerWidth - width * scale) / 2; top_ = 44 + (room[1] - height * scale) / 2; place();
};
const zoom_at = (x, y, factor) => {
  const wanted = Math.min(32, Math.max(0.05, scale * factor));
  left = x - (x - left) * wanted / scale; top_ = y - (y - top_) * wanted / scale; scale = wanted; place();
};
document.addEventListener('click', (event) => {
  const picture = event.target.closest('[data-zoom]');
  if (!picture) return;
  [width, height] = picture.dataset.zoom.split(' ').map(Number);
  const look = picture.matches('.content') ? picture.firstElementChild : picture;
  stage.style.cssText = `width:${width}px;height:${height}px;background-image:${getComputedStyle(look).backgroundImage};` +
    (picture.dataset.at ? `background-position:${picture.dataset.at};` : '') +
    `background-size:${picture.dataset.period ?? 'auto'}`;
  words.textContent = picture.getAttribute('aria-label');
  dialog.showModal(); fit(picture.matches('.preview') ? 1 : 0);
});
stage.addEventListener('pointerdown', (event) => { stage.setPointerCapture(event.pointerId); event.preventDefault(); });
stage.addEventListener('pointermove', (event) => {
  if (!stage.hasPointerCapture(event.pointerId)) return;
  left += event.movementX; top_ += event.movementY; place();
});
dialog.addEventListener('wheel', (event) => { event.preventDefault(); zoom_at(event.clientX, event.clientY, event.deltaY < 0 ? 1.25 : 0.8); }, {passive: false});
dialog.addEventListener('keydown', (event) => {
  const step = {ArrowLeft: [80, 0], ArrowRight: [-80, 0], ArrowUp: [0, 80], ArrowDown: [0, -80]}[event.key];
  if (step) { left += step[0]; top_ += step[1]; place(); event.preventDefault(); }
  if ('+=-'.includes(event.key)) zoom_at(innerWidth / 2, innerHeight / 2, event.key === '-' ? 0.8 : 1.25);
});
dialog.querySelector('[data-close]').addEventListener('click', () => dialog.close());
dialog.querySelector('[data-fit]').addEventListener('click', () => fit(0));
dialog.addEventListener('click', (event) => { if (event.target === dialog) dialog.close(); });
for (const button of document.querySelectorAll('[data-level]'))
  button.addEventListener('click', () => {
    for (const other of document.querySelectorAll('[data-level]')) other.setAttribute('aria-pressed', other === button);
    for (const pair of document.querySelectorAll('[data-preview]')) pair.hidden = pair.dataset.preview !== button.dataset.level;
  });
document.querySelector('[data-level]')?.click();
)js";

}  // namespace tessera
