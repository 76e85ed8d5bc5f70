'use strict';
const report = JSON.parse(document.getElementById('report').textContent);
const rows = report.rows ?? [], $ = (id) => document.getElementById(id);
const svgNs = 'http://www.w3.org/2000/svg';
const familyOf = (filter) => families.find(([prefix]) => filter.startsWith(prefix)) ?? ['', filter, '#777777'];
const colorOf = (filter) => familyOf(filter)[0] === 'exact' ? 'var(--exact)' : familyOf(filter)[2];
const element = (name, attributes = {}, ...children) => {
  const made = name.startsWith('svg:') ? document.createElementNS(svgNs, name.slice(4)) : document.createElement(name);
  for (const [key, value] of Object.entries(attributes))
    if (key.startsWith('on')) made.addEventListener(key.slice(2), value);
    else if (value !== undefined && value !== false) made.setAttribute(key, value);
  made.append(...children.filter((child) => child !== undefined && child !== null));
  return made;
};
const unique = (values) => [...new Set(values)];
const digits = (value, count = 3) => value === 0 ? '0' : Math.abs(value) >= 1000 ? Math.round(value).toLocaleString('en') :
  Math.abs(value) < 1e-4 ? value.toExponential(1).replace('e-', '·10⁻').replace(/⁻(\d+)/, (_, n) => '⁻' + [...n].map((d) => '⁰¹²³⁴⁵⁶⁷⁸⁹'[d]).join('')) : Number(value.toPrecision(count)).toString();
const duration = (ns) => ns >= 1e6 ? digits(ns / 1e6) + ' ms' : ns >= 1e3 ? digits(ns / 1e3) + ' µs' : digits(ns) + ' ns';
const timeOf = (row) => row.nanoseconds_per_sample > 0 ? row.nanoseconds_per_sample : row.frame_milliseconds * 1e6;
const isFrame = (row) => !(row.nanoseconds_per_sample > 0);
const placeTitle = (where) => where === 'cpu' ? 'Processor' : 'GPU: ' + where;

// What is shown now; the address keeps it
const state = {situation: '', texture: '', where: 'cpu', x: 'time', y: 'mse', left: 'anisotropic-16', right: '', view: 'picture', sort: 'time', down: false, hidden: new Set()};
const shownRows = () => rows.filter((row) => row.situation === state.situation && row.texture === state.texture && row.where === state.where);
const rowOf = (filter) => shownRows().find((row) => row.filter === filter);

function choices(holder, values, titleOf, current, choose) {
  holder.replaceChildren(...values.map((value) => element('button', {'aria-pressed': value === current, onclick: () => choose(value)}, titleOf(value))));
  holder.hidden = values.length < 2;
}

// Logarithmic axes

const ticksOf = (from, to) => { const out = []; for (let e = Math.round(Math.log10(from)); e <= Math.round(Math.log10(to)); ++e) out.push(10 ** e); return out; };
function rangeOf(values, least = 0) {
  const good = values.filter((value) => value > 0).map((value) => Math.max(value, least));
  if (!good.length) return [1, 10];
  const from = 10 ** Math.floor(Math.log10(Math.min(...good)) + 1e-9), to = 10 ** Math.ceil(Math.log10(Math.max(...good)) - 1e-9);
  return [from, Math.max(to, from * 10)];
}
const scaleOf = ([from, to], begin, end) => (value) => begin + (end - begin) * (Math.log10(Math.max(value, from)) - Math.log10(from)) / (Math.log10(to) - Math.log10(from));
function axes(svg, box, xs, ys, x, y, xLabel, yLabel, xTitle, yTitle) {
  for (const tick of ticksOf(...xs)) svg.append(element('svg:line', {class: 'grid-line', x1: x(tick), x2: x(tick), y1: box.top, y2: box.bottom}),
    element('svg:text', {x: x(tick), y: box.bottom + 19, 'text-anchor': 'middle'}, xLabel(tick)));
  for (const tick of ticksOf(...ys)) svg.append(element('svg:line', {class: 'grid-line', x1: box.left, x2: box.right, y1: y(tick), y2: y(tick)}),
    element('svg:text', {x: box.left - 9, y: y(tick) + 4, 'text-anchor': 'end'}, yLabel(tick)));
  svg.append(element('svg:text', {class: 'title', x: box.right, y: box.bottom + 40, 'text-anchor': 'end'}, xTitle),
    element('svg:text', {class: 'title', x: box.left - 52, y: box.top - 12}, yTitle));
}

// The plot

const errorTitles = {mse: 'mean squared error, codes²', mse_linear: 'mean squared error, codes² of linear light', max_error: 'greatest error, codes', dissimilarity: '1 − MS-SSIM'};
const errorOf = (row) => state.y === 'dissimilarity' ? (row.ms_ssim > 0 ? 1 - row.ms_ssim : NaN) : row[state.y];
const costOf = (row) => state.x === 'time' ? timeOf(row) : row[state.x];
const leastShown = {mse: 1e-4, mse_linear: 1e-4, max_error: 1e-2, dissimilarity: 1e-6};

/** The steps of what nothing beats in both. */
function frontOf(points) {
  const front = [];
  for (const point of [...points].sort((a, b) => costOf(a) - costOf(b) || errorOf(a) - errorOf(b)))
    if (!front.length || errorOf(point) < errorOf(front.at(-1))) front.push(point);
  return front;
}

function drawPlot() {
  const svg = $('plot'), width = Math.max(340, svg.clientWidth || svg.parentElement.clientWidth), height = Math.min(600, Math.max(380, width * 0.5));
  svg.setAttribute('viewBox', `0 0 ${width} ${height}`); svg.setAttribute('height', height); svg.replaceChildren();
  const points = shownRows().filter((row) => costOf(row) > 0 && Number.isFinite(errorOf(row)) && !state.hidden.has(familyOf(row.filter)[1]));
  if (!points.length) { svg.append(element('svg:text', {x: width / 2, y: height / 2, 'text-anchor': 'middle'}, 'Nothing was measured here.')); return; }
  const box = {left: 66, right: width - 22, top: 34, bottom: height - 52}, least = leastShown[state.y];
  const xs = rangeOf(points.map(costOf)), ys = rangeOf(points.map(errorOf), least), x = scaleOf(xs, box.left, box.right), y = scaleOf(ys, box.bottom, box.top);
  const frame = isFrame(points[0]);
  axes(svg, box, xs, ys, x, y, state.x === 'time' ? duration : digits, digits, state.x === 'time' ? (frame ? 'time for a frame' : 'time for a sample, one thread') : 'texels or table entries fetched for a sample', errorTitles[state.y]);
  const truth = points[0][state.y === 'mse' ? 'truth_mse' : ''] ?? 0;
  if (truth > 0) svg.append(element('svg:line', {class: 'truth', x1: box.left, x2: box.right, y1: y(truth), y2: y(truth)}),
    element('svg:text', {x: box.right - 4, y: y(truth) - 6, 'text-anchor': 'end'}, `the ground truth’s own error, ${digits(truth)}`));
  const front = frontOf(points), onFront = new Set(front);
  svg.append(element('svg:path', {class: 'front', d: front.map((row, i) => i ? `H${x(costOf(row))}V${y(errorOf(row))}` : `M${x(costOf(row))} ${y(errorOf(row))}`).join('')}));
  const labels = [], names = [], dots = [];
  for (const row of [...points].sort((a, b) => onFront.has(a) - onFront.has(b))) {
    const cx = x(costOf(row)), cy = y(errorOf(row)), color = colorOf(row.filter), good = onFront.has(row), chosen = row.filter === state.left || row.filter === state.right;
    const point = element('svg:g', {class: 'point', tabindex: 0, role: 'button', 'aria-label': row.filter, onpointerenter: () => showTip(row, cx, cy), onpointerleave: hideTip,
      onfocus: () => showTip(row, cx, cy), onblur: hideTip, onclick: () => choose(row.filter), onkeydown: (event) => { if (event.key === 'Enter') choose(row.filter); }},
      chosen ? element('svg:circle', {cx, cy, r: 13, fill: color, opacity: 0.25}) : null,
      element('svg:circle', {cx, cy, r: 11, fill: 'transparent'}),
      element('svg:circle', {cx, cy, r: good ? 6.5 : 5, fill: good ? color : 'var(--card)', stroke: good ? 'var(--text)' : color, 'stroke-width': good ? 1.6 : 2.2}));
    const at = cx > box.right - 150 ? {x: cx - 12, end: 'end'} : {x: cx + 12, end: 'start'}, length = row.filter.length * 7.2, begin = at.end === 'end' ? at.x - length : at.x;
    const label = {left: begin, right: begin + length, top: cy - 18, bottom: cy - 2};
    if ((good || chosen) && !labels.some((other) => label.left < other.right && label.right > other.left && label.top < other.bottom && label.bottom > other.top)) {
      labels.push(label);
      names.push(element('svg:text', {class: 'name', x: at.x, y: cy - 6, 'text-anchor': at.end}, row.filter));
    }
    dots.push(point);
  }
  svg.append(...names, ...dots);
}

function showTip(row, x, y) {
  const tip = $('tip'), scale = $('plot').clientWidth / $('plot').viewBox.baseVal.width;
  const lines = [[isFrame(row) ? 'Time for a frame' : 'Time', duration(timeOf(row))], ['Texels', digits(row.texels_per_sample)], ['MSE', digits(row.mse)], ['PSNR', digits(row.psnr) + ' dB'],
    ['MS-SSIM', row.ms_ssim > 0 ? row.ms_ssim.toFixed(5) : 'not measured'], ['Greatest error', digits(row.max_error) + ' codes'], ...(row.bound_codes > 0 ? [['Stated bound', digits(row.bound_codes) + ' linear codes']] : []),
    ...(row.truth_mse > 0 ? [['Truth’s own MSE', digits(row.truth_mse)]] : [])];
  tip.replaceChildren(element('b', {}, row.filter), ...(row.pareto ? [element('span', {}, 'on the Pareto front')] : []), element('dl', {}, ...lines.flatMap(([name, value]) => [element('dt', {}, name), element('dd', {}, value)])));
  tip.hidden = false;
  const room = $('plot').clientWidth, left = x * scale + 18;
  tip.style.left = (left + tip.offsetWidth > room ? x * scale - tip.offsetWidth - 18 : left) + 'px';
  tip.style.top = Math.max(0, Math.min(y * scale - 30, $('plot').clientHeight - tip.offsetHeight)) + 'px';
}
function hideTip() { $('tip').hidden = true; }

function drawLegend() {
  $('legend').replaceChildren(...unique(shownRows().map((row) => familyOf(row.filter)[1])).map((title) => element('button', {style: `--color:${colorOf(shownRows().find((row) => familyOf(row.filter)[1] === title).filter)}`,
    'aria-pressed': !state.hidden.has(title), onclick: () => { state.hidden.has(title) ? state.hidden.delete(title) : state.hidden.add(title); drawPlot(); drawLegend(); }}, element('i'), title)));
}

// Pictures

const truthName = 'the truth';
const stem = () => `pictures/${state.situation}-${state.texture}`;
const pictureOf = (filter) => filter === truthName ? `${stem()}-truth.png` : rowOf(filter)?.[state.view] || '';
const viewWords = {
  picture: 'Each pixel is one sample. The truth is the average over the quadrilateral that the pixel’s outline subtends on the texture.',
  error_picture: 'Differences from the truth in sRGB codes, eight times; black is right.',
  count_picture: 'Texels, or entries of tables, that each pixel fetched. Green: fewer than the 128 of sixteen trilinear probes; red: more; grey: magnified, less than a texel to a pixel; dark: sky.',
};
function caption(filter) {
  const row = rowOf(filter);
  if (!row) return [element('b', {}, filter)];
  return [element('b', {}, filter), ` MSE ${digits(row.mse)} · ${row.ms_ssim > 0 ? 'MS-SSIM ' + row.ms_ssim.toFixed(4) + ' · ' : ''}${digits(row.texels_per_sample)} texels · ${duration(timeOf(row))}`];
}
function drawPictures() {
  const withPicture = shownRows().filter((row) => row.picture), names = withPicture.map((row) => row.filter);
  const known = state.where === 'cpu' ? [truthName, ...names] : names;
  if (!known.includes(state.left)) state.left = known.find((name) => name.startsWith('anisotropic')) ?? known[0] ?? '';
  if (!known.includes(state.right)) state.right = bestLine(names) ?? known.at(-1) ?? '';
  for (const side of ['left', 'right']) {
    $(`${side}-filter`).replaceChildren(...known.map((name) => element('option', {value: name, selected: name === state[side]}, name)));
    const image = $(`${side}-picture`), source = pictureOf(state[side]) || (state[side] === truthName ? '' : pictureOf(truthName));
    if (source) image.src = source; else image.removeAttribute('src');
    image.alt = `${state[side]}: ${state.situation}, ${state.texture}`;
    $(`${side}-caption`).replaceChildren(...caption(state[side]));
  }
  for (const button of $('views').children) button.setAttribute('aria-pressed', button.dataset.view === state.view);
  $('view-words').textContent = viewWords[state.view];
  sizePictures();
}
const bestLine = (names) => names.filter((name) => name.startsWith('line-integral')).sort((a, b) => rowOf(a).mse - rowOf(b).mse)[0];
let zoomed = false;
function sizePictures() {
  const wide = $('left-picture').naturalWidth;
  // A small picture is shown about as wide as half the page, until somebody chooses otherwise
  if (wide && !zoomed) $('zoom').value = Math.max(1, Math.round(700 / wide));
  for (const id of ['left-picture', 'right-picture']) if ($(id).naturalWidth) $(id).style.width = $(id).naturalWidth * $('zoom').value + 'px';
}
function divide(share) {
  const percent = Math.min(100, Math.max(0, share * 100));
  $('clip').style.width = $('handle').style.left = percent + '%';
  $('handle').setAttribute('aria-valuenow', Math.round(percent));
}
function flip() { [state.left, state.right] = [state.right, state.left]; drawPictures(); drawPlot(); remember(); }
function choose(filter) { if (filter !== state.right) state.right = filter; drawPictures(); drawPlot(); drawTable(); remember(); }

// The table

const columns = [['filter', 'Filter', (row) => row.filter], ['mse', 'MSE', (row) => row.mse], ['truth_mse', 'truth’s own', (row) => row.truth_mse], ['psnr', 'PSNR, dB', (row) => row.psnr], ['ms_ssim', 'MS-SSIM', (row) => row.ms_ssim],
  ['max_error', 'greatest, codes', (row) => row.max_error], ['bound_codes', 'bound, linear codes', (row) => row.bound_codes], ['texels_per_sample', 'texels', (row) => row.texels_per_sample], ['time', 'time', timeOf]];
function cell(key, row) {
  if (key === 'filter') return element('td', {class: 'words'}, element('span', {class: 'mark', style: `--color:${colorOf(row.filter)}`}), row.filter, row.pareto ? element('span', {class: 'star', title: 'on the Pareto front'}, ' ★') : '');
  if (key === 'truth_mse') return element('td', {class: 'quiet'}, row.truth_mse > 0 ? '± ' + digits(row.truth_mse, 2) : 'analytic');
  if (key === 'ms_ssim') return element('td', {}, row.ms_ssim > 0 ? row.ms_ssim.toFixed(5) : '–');
  if (key === 'bound_codes') return element('td', {}, row.bound_codes > 0 ? digits(row.bound_codes) : '–');
  if (key === 'psnr') return element('td', {}, row.psnr >= 200 ? '∞' : row.psnr.toFixed(2));
  if (key === 'time') return element('td', {}, duration(timeOf(row)) + (isFrame(row) ? ' a frame' : ''));
  return element('td', {}, digits(row[key], 4));
}
function drawTable() {
  const everywhere = $('everywhere').checked, value = (columns.find(([key]) => key === state.sort) ?? columns[0])[2];
  const shown = [...(everywhere ? rows : shownRows())].sort((a, b) => (value(a) < value(b) ? -1 : value(a) > value(b) ? 1 : 0) * (state.down ? -1 : 1));
  const head = columns.map(([key, title]) => element('th', {class: key === 'filter' ? 'words' : '', 'aria-sort': state.sort === key ? (state.down ? 'descending' : 'ascending') : 'none'},
    element('button', {onclick: () => { state.down = state.sort === key && !state.down; state.sort = key; drawTable(); }}, title)));
  if (everywhere) head.splice(1, 0, element('th', {class: 'words'}, 'Where'));
  $('figures').tHead.replaceChildren(element('tr', {}, ...head));
  $('figures').tBodies[0].replaceChildren(...shown.map((row) => {
    const cells = columns.map(([key]) => cell(key, row));
    if (everywhere) cells.splice(1, 0, element('td', {class: 'words quiet'}, `${row.situation}, ${row.texture}${row.where === 'cpu' ? '' : ', GPU'}`));
    return element('tr', {class: !everywhere && (row.filter === state.left || row.filter === state.right) ? 'on' : '', onclick: () => { Object.assign(state, {situation: row.situation, texture: row.texture, where: row.where}); state.right = row.filter; draw(); }}, ...cells);
  }));
}

// Small charts: lines over a common axis

const lineColors = ['#d63031', '#1f6f8b', '#2e8b57', '#c0891a', '#7a4fa8', '#8c6a42'];
function chart(title, lines, xTitle, yTitle, xLabel = digits, logarithmicX = true) {
  const width = 560, height = 300, box = {left: 64, right: width - 14, top: 30, bottom: height - 48}, svg = element('svg:svg', {viewBox: `0 0 ${width} ${height}`, role: 'img', 'aria-label': title});
  const all = lines.flatMap((line) => line.points), positive = all.map(([, y]) => y).filter((y) => y > 0);
  const ys = positive.length ? rangeOf(positive, 1e-6) : [1e-3, 1], zero = all.some(([, y]) => !(y > 0)), values = all.map(([x]) => x), from = Math.min(...values), to = Math.max(...values, from + 1);
  if (zero) ys[0] /= 10;
  const y = scaleOf(ys, box.bottom, box.top), x = logarithmicX ? scaleOf([from, to], box.left, box.right) : (value) => box.left + (box.right - box.left) * (value - from) / (to - from);
  for (const tick of unique(values).filter((_, i, list) => list.length <= 9 || i % 3 === 0)) svg.append(element('svg:text', {x: x(tick), y: box.bottom + 19, 'text-anchor': 'middle'}, xLabel(tick)));
  for (const tick of ticksOf(...ys)) svg.append(element('svg:line', {class: 'grid-line', x1: box.left, x2: box.right, y1: y(tick), y2: y(tick)}),
    element('svg:text', {x: box.left - 9, y: y(tick) + 4, 'text-anchor': 'end'}, zero && tick === ys[0] ? '0' : digits(tick)));
  svg.append(element('svg:text', {class: 'title', x: box.right, y: box.bottom + 40, 'text-anchor': 'end'}, xTitle), element('svg:text', {class: 'title', x: 4, y: box.top - 13}, yTitle));
  lines.forEach((line, i) => {
    const color = lineColors[i % lineColors.length];
    svg.append(element('svg:path', {d: line.points.map(([px, py], k) => `${k ? 'L' : 'M'}${x(px)} ${y(py)}`).join(''), fill: 'none', stroke: color, 'stroke-width': 2.2, 'stroke-linejoin': 'round'}));
    for (const [px, py, words] of line.points) svg.append(element('svg:circle', {cx: x(px), cy: y(py), r: 3.6, fill: color}, element('svg:title', {}, `${line.name}: ${words ?? digits(py)}`)));
  });
  return element('figure', {}, element('figcaption', {}, title), svg, element('div', {class: 'keys'}, ...lines.map((line, i) => element('span', {style: `--color:${lineColors[i % lineColors.length]}`}, element('i'), line.name))));
}

const comparisons = [
  ['light', 'Linear light or sRGB codes', 'MIP levels averaged in sRGB codes, as is often done, against averages of light. Linear light costs a table look-up; codes darken whatever has contrast.'],
  ['statistical', 'Above the tile level: choices counted or expected', 'Where one texel covers many tiles, independent choices have to be enumerated (exact) or expected (fast, with a bound); the typed quadtree is exact at constant cost.'],
  ['descent', 'Layers: how deep to descend', 'Layers composited d levels below the one asked for, then reduced. Each level costs four times the texels and shrinks the error.'],
  ['content-depth', 'Contents in 8 or 16 bits', 'Four weighted contents stored and summed level by level. What 8 bits round away at each level adds up; 16-bit linear steps keep it.'],
  ['integral', 'Column sums in floats or integers', 'The mean of 16 texels as the difference of two sums at the end of a column. Integers are as fast and stay exact.'],
];
function drawPages() {
  const pages = report.pages ?? [];
  $('pages-section').hidden = !pages.length;
  $('pages').replaceChildren(...comparisons.flatMap(([key, title, words]) => {
    const mine = pages.filter((row) => row.comparison === key);
    if (!mine.length) return [];
    const charts = unique(mine.map((row) => row.texture)).flatMap((texture) => {
      const here = mine.filter((row) => row.texture === texture), settings = unique(here.map((row) => row.setting));
      const lines = (value, words) => settings.map((name) => ({name, points: here.filter((row) => row.setting === name).map((row) => [row.level, value(row), words(row)])}));
      const level = key === 'integral' ? (n) => '2^' + n : (n) => String(n), xTitle = key === 'integral' ? 'texels in the column' : 'level';
      return [chart(`${texture}: error`, lines((row) => row.max_error, (row) => digits(row.max_error) + ' codes'), xTitle, 'greatest error, codes of linear light', level, false),
        chart(`${texture}: time`, lines((row) => row.milliseconds, (row) => digits(row.milliseconds) + ' ms'), xTitle, 'milliseconds', level, false)];
    });
    const head = ['Texture', 'Setting', 'Level', 'MSE', 'greatest, codes', 'bound', 'ms'];
    return [element('h3', {}, title), element('p', {}, words), element('div', {class: 'grid'}, ...charts), element('details', {}, element('summary', {}, `${mine.length} rows`), element('div', {class: 'wide'}, element('table', {},
      element('thead', {}, element('tr', {}, ...head.map((name, i) => element('th', {class: i < 2 ? 'words' : ''}, name)))), element('tbody', {}, ...mine.map((row) => element('tr', {}, element('td', {class: 'words'}, row.texture), element('td', {class: 'words'}, row.setting),
        ...[row.level, row.mse, row.max_error].map((value) => element('td', {}, digits(value))), element('td', {}, row.bound_codes > 0 ? digits(row.bound_codes) + (row.confidence < 1 ? ` at ${row.confidence}` : '') : '–'), element('td', {}, digits(row.milliseconds))))))))];
  }));
  const curves = report.curves ?? [];
  $('curves-section').hidden = !curves.length;
  $('curves').replaceChildren(...unique(curves.map((curve) => curve.x_name)).map((over) => chart(over.includes('column') ? 'Column sums' : 'Summed-area tables', curves.filter((curve) => curve.x_name === over)
    .map((curve) => ({name: curve.name, points: curve.x.map((x, i) => [x, curve.y[i], digits(curve.y[i]) + ' codes'])})), over, 'greatest error, codes', (value) => value >= 1 << 20 ? (value >> 20) + 'M' : value >= 1024 ? (value >> 10) + 'k' : value)));
}

function drawClaims() {
  const claims = report.claims ?? [], held = claims.filter((claim) => claim.holds).length;
  $('verdict').replaceChildren(element('span', {class: `verdict ${held === claims.length ? 'pass' : 'fail'}`}, `${held} of ${claims.length} hold`));
  $('claims').replaceChildren(...claims.map((claim) => element('li', {}, element('span', {class: `verdict ${claim.holds ? 'pass' : 'fail'}`}, claim.holds ? 'holds' : 'fails'), element('div', {}, claim.text, element('small', {}, claim.figures)))));
}

const counted = (count, what) => `${count} ${what}${count === 1 ? '' : 's'}`;

function drawFacts() {
  const sampled = rows.filter((row) => row.truth_mse > 0), size = rows.reduce((most, row) => Math.max(most, row.pixels ?? 0), 0);
  $('facts').replaceChildren(...[report.machine, counted(rows.length, 'row'), counted(unique(rows.map((row) => row.filter)).length, 'filter'), counted(unique(rows.map((row) => row.texture)).length, 'texture')].filter(Boolean).map((fact) => element('li', {}, fact)));
  const notes = [
    ['Made by ', element('code', {}, report.made_by || 'tessera accuracy')],
    ['The truth of a pixel is the area integral over the quadrilateral that its outline subtends, of texels that are squares of one colour, in linear light. Errors are in 8-bit sRGB codes with their fractions kept.'],
    [`Of a checker and of text the truth is analytic. Elsewhere it is sampled, two points in each stratum of the footprint; how much the two differ tells the truth’s own expected error, at most ${digits(Math.max(0, ...sampled.map((row) => row.truth_mse)))} here. A filter cannot be seen to be better than that.`],
    [`Up to ${size.toLocaleString('en')} pixels a picture; the sky and pixels across the horizon are not measured. A filter that would take too long on a scene is measured on evenly spread pixels and has no picture.`],
    ['Times are processor time of one thread, medians of rounds in which every filter takes its turn, with tables and pages warm: the cost of a sample, not of loading. Texels count fetches, or entries of tables.'],
    ['MS-SSIM is that of Wang, Simoncelli and Bovik (2003), of luma.'],
  ];
  $('notes').replaceChildren(...notes.map((words) => element('li', {}, ...words)));
}

// All together

function remember() { history.replaceState(null, '', '#' + new URLSearchParams({situation: state.situation, texture: state.texture, where: state.where, left: state.left, right: state.right, view: state.view})); }
function draw() {
  const situations = unique(rows.map((row) => row.situation)), textures = unique(rows.filter((row) => row.situation === state.situation).map((row) => row.texture));
  if (!textures.includes(state.texture)) state.texture = textures[0];
  const places = unique(rows.filter((row) => row.situation === state.situation && row.texture === state.texture).map((row) => row.where));
  if (!places.includes(state.where)) state.where = places[0];
  choices($('situations'), situations, (name) => situationTitles.get(name) ?? name, state.situation, (name) => { state.situation = name; draw(); });
  choices($('textures'), textures, (name) => name, state.texture, (name) => { state.texture = name; draw(); });
  choices($('places'), places, placeTitle, state.where, (name) => { state.where = name; draw(); });
  drawPictures(); drawPlot(); drawLegend(); drawTable(); remember();
}

for (const [key, value] of new URLSearchParams(location.hash.slice(1))) if (key in state && typeof state[key] === 'string') state[key] = value;
if (!rows.some((row) => row.situation === state.situation)) state.situation = rows[0]?.situation ?? '';
for (const axis of ['x', 'y']) $(`${axis}-axis`).addEventListener('change', (event) => { state[axis] = event.target.value; drawPlot(); });
for (const button of $('views').children) button.addEventListener('click', () => { state.view = button.dataset.view; drawPictures(); remember(); });
for (const side of ['left', 'right']) {
  $(`${side}-filter`).addEventListener('change', (event) => { state[side] = event.target.value; drawPictures(); drawPlot(); drawTable(); remember(); });
  $(`${side}-picture`).addEventListener('load', sizePictures);
}
$('flip').addEventListener('click', flip);
$('zoom').addEventListener('input', () => { zoomed = true; sizePictures(); });
$('everywhere').addEventListener('change', drawTable);
const compare = $('compare'), dragTo = (event) => { const box = compare.getBoundingClientRect(); divide((event.clientX - box.left) / box.width); };
compare.addEventListener('pointerdown', (event) => { compare.setPointerCapture(event.pointerId); dragTo(event); event.preventDefault(); });
compare.addEventListener('pointermove', (event) => { if (compare.hasPointerCapture(event.pointerId)) dragTo(event); });
$('handle').addEventListener('keydown', (event) => {
  const step = {ArrowLeft: -2, ArrowRight: 2}[event.key];
  if (step) { divide((Number($('handle').getAttribute('aria-valuenow')) + step) / 100); event.preventDefault(); }
});
addEventListener('keydown', (event) => { if (event.key === 'f' && !event.target.closest('select, input')) flip(); });
addEventListener('resize', drawPlot);
drawFacts(); drawClaims(); drawPages();
if (rows.length) draw();
