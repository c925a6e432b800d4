"use strict";
// The deviation curve with its band, drawn from the card: the card has every 15° of a smooth
// periodic curve, and between them the trigonometric interpolation is exact to its harmonics.
const CURVE = { height: 300, left: 52, right: 16, top: 14, bottom: 34 }; // pixels
const STEP_DEG = 3;
const reader = document.getElementById("curve-reader");
let drawnCard = "";
let drawnWidth = 0;
let curve = null; // functions of the compass heading in degrees

function interpolation(values) {
  const count = values.length;
  const harmonics = [];
  for (let order = 0; order <= count / 2; order += 1) {
    let cosine = 0, sine = 0;
    values.forEach((value, index) => {
      cosine += value * Math.cos((2 * Math.PI * order * index) / count);
      sine += value * Math.sin((2 * Math.PI * order * index) / count);
    });
    const share = order === 0 || order === count / 2 ? 1 / count : 2 / count;
    harmonics.push([cosine * share, sine * share]);
  }
  return (deg) => harmonics.reduce((sum, [cosine, sine], order) => {
    const angle = (order * deg * Math.PI) / 180;
    return sum + cosine * Math.cos(angle) + sine * Math.sin(angle);
  }, 0);
}

function shape(name, attributes, text) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, String(value));
  if (text !== undefined) made.textContent = text;
  return made;
}
// A round step that gives at most six lines.
function gridStep(span) {
  return [0.5, 1, 2, 5, 10, 20, 50].find((step) => span / step <= 6) ?? 90;
}
const across = (deg) => CURVE.left + (deg / 360) * (drawnWidth - CURVE.left - CURVE.right);

function drawCurve(card) {
  const deviation = interpolation(card.map((row) => row.deviation_deg));
  const hasBand = card.every((row) => row.band95_deg != null);
  const margin = hasBand ? interpolation(card.map((row) => row.band95_deg)) : () => 0;
  const points = Array.from({ length: 360 / STEP_DEG + 1 }, (_, index) => index * STEP_DEG);
  const highs = points.map((deg) => deviation(deg) + margin(deg));
  const lows = points.map((deg) => deviation(deg) - margin(deg));
  const step = gridStep(Math.max(...highs, 0.5) - Math.min(...lows, -0.5));
  const top = Math.ceil(Math.max(...highs, 0.5) / step) * step;
  const bottom = Math.floor(Math.min(...lows, -0.5) / step) * step;
  const up = (deg) => CURVE.top + ((top - deg) / (top - bottom)) * (CURVE.height - CURVE.top - CURVE.bottom);
  curve = { deviation, margin: hasBand ? margin : null, up };

  const svg = document.getElementById("curve");
  const parts = [];
  for (let line = bottom; line <= top + step / 2; line += step) {
    const y = up(line);
    parts.push(shape("line", { class: Math.abs(line) < 1e-9 ? "zero" : "grid", x1: across(0), x2: across(360), y1: y, y2: y }));
    const label = Math.abs(line) < 1e-9 ? "0°" : Math.abs(line) + "° " + (line < 0 ? "W" : "E");
    parts.push(shape("text", { x: CURVE.left - 8, y: y + 4, "text-anchor": "end" }, label));
  }
  for (let deg = 0; deg <= 360; deg += drawnWidth < 500 ? 90 : 45) {
    parts.push(shape("line", { class: "grid", x1: across(deg), x2: across(deg), y1: up(top), y2: up(bottom) }));
    const anchor = deg === 360 ? "end" : "middle";
    parts.push(shape("text", { x: across(deg), y: CURVE.height - 12, "text-anchor": anchor }, String(deg % 360).padStart(3, "0") + "°"));
  }
  const path = (values) => values.map((value, index) => across(points[index]).toFixed(1) + "," + up(value).toFixed(1));
  if (hasBand) parts.push(shape("polygon", { class: "band", points: [...path(highs), ...path(lows).reverse()].join(" ") }));
  parts.push(shape("polyline", { class: "line", points: path(points.map(deviation)).join(" ") }));
  parts.push(shape("line", { class: "read", id: "curve-read", y1: up(top), y2: up(bottom) }));
  parts.push(shape("line", { class: "here", id: "curve-here", y1: up(top), y2: up(bottom) }));
  parts.push(shape("circle", { class: "dot", id: "curve-dot", r: 5 }));
  svg.replaceChildren(...parts);

  const greatest = (sign) => points.reduce((best, deg) => sign * deviation(deg) > sign * deviation(best) ? deg : best);
  const [east, west] = [greatest(1), greatest(-1)];
  document.getElementById("curve-says").textContent = "From " + side(deviation(west)) + " on " + degrees(west % 360) +
    " to " + side(deviation(east)) + " on " + degrees(east % 360) + " by compass" +
    (hasBand ? ", with the band that holds 95 of 100 readings." : ".");
  readCurve();
}

// What the curve says on the heading of the slider.
function readCurve() {
  if (curve == null) return;
  const deg = Number(reader.value);
  const said = "On " + String(deg).padStart(3, "0") + "° by compass: " + side(curve.deviation(deg)) +
    (curve.margin ? band(curve.margin(deg)) : "");
  document.getElementById("curve-value").textContent = said;
  reader.setAttribute("aria-valuetext", said);
  const line = document.getElementById("curve-read");
  line.setAttribute("x1", across(deg));
  line.setAttribute("x2", across(deg));
}

function showCurve(card, compass) {
  document.getElementById("curve-figure").hidden = card.length === 0;
  const text = JSON.stringify(card);
  const width = document.getElementById("curve").clientWidth;
  if (text !== drawnCard || width !== drawnWidth) {
    drawnCard = text;
    drawnWidth = width;
    if (card.length === 0) curve = null;
    else drawCurve(card);
  }
  if (curve == null) return;
  const hidden = compass == null ? "hidden" : "visible";
  const [line, dot] = [document.getElementById("curve-here"), document.getElementById("curve-dot")];
  for (const mark of [line, dot]) mark.setAttribute("visibility", hidden);
  if (compass == null) return;
  line.setAttribute("x1", across(compass));
  line.setAttribute("x2", across(compass));
  dot.setAttribute("cx", across(compass));
  dot.setAttribute("cy", curve.up(curve.deviation(compass)));
}
reader.addEventListener("input", readCurve);
