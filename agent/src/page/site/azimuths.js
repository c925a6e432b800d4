"use strict";
// Azimuths. The agent works out their errors, with or without a link.
const azimuthForm = byId("azimuth");
const sight = azimuthForm.elements;
const kinds = Object.fromEntries([...sight.kind.options].map((option) => [option.value, option.text]));
const anglesOf = ["compass_heading_deg", "compass_bearing_deg", "gyro_heading_deg", "gyro_bearing_deg",
  "height_of_eye_m", "true_bearing_deg", "altitude_deg"];
const cautions = {
  high_altitude: "the body is high: the tilt of the azimuth circle spoils the bearing",
  grazing_horizon: "the sun moves along the horizon: the refraction spoils the amplitude",
  alongside: "the berth's steel may deflect the compass: this checks the gyro",
};
let azimuthId = null; // of the azimuth in the form
let listedAzimuths = "";

const second = (time) => time == null ? "" : new Date(time).toISOString().slice(0, 19);
// Reads 43.4, -3.1, 43 24.0 N and 3°06.0' W; NaN for anything else.
function coordinate(typed, positive, negative) {
  const found = typed.trim().toUpperCase().replace(",", ".")
    .match(/^(-?)(\d+(?:\.\d+)?)(?:[\s°]+(\d+(?:\.\d+)?))?[\s'′°]*([NSEW]?)$/);
  if (!found) return NaN;
  const [, minus, whole, minutes, letter] = found;
  const wrong = (letter && letter !== positive && letter !== negative) || (minus && letter) ||
    Number(minutes ?? 0) >= 60 || (minutes !== undefined && whole.includes("."));
  if (wrong) return NaN;
  const size = Number(whole) + Number(minutes ?? 0) / 60;
  return minus || letter === negative ? -size : size;
}
function written(value, positive, negative, digits) {
  const minutes = Math.round(Math.abs(value) * 6000) / 100;
  const whole = Math.floor(minutes / 60);
  return String(whole).padStart(digits, "0") + " " + (minutes - 60 * whole).toFixed(2).padStart(5, "0") +
    " " + (value < 0 ? negative : positive);
}
// An empty field is no value; anything but a number is a fault of that field.
function number(name) {
  const typed = sight[name].value.trim().replace(",", ".");
  if (sight[name].closest("label").hidden || typed === "") return null;
  if (!/^-?\d+(\.\d+)?$/.test(typed)) throw new Error(label(name) + ": " + typed + " is not a number");
  return Number(typed);
}
const label = (name) => sight[name].closest("label").firstChild.textContent || name;

function mark() {
  sight.time.value = second(latest?.ship_time ?? new Date());
  const place = latest?.position;
  if (place) {
    sight.lat.value = written(place.lat, "N", "S", 2);
    sight.lon.value = written(place.lon, "E", "W", 3);
  }
  const reading = (value) => value == null ? "" : value.toFixed(1);
  sight.compass_heading_deg.value = reading(latest?.heading.compass_deg);
  sight.gyro_heading_deg.value = reading(latest?.gyro_deg);
}
function fitAzimuth() {
  for (const part of azimuthForm.querySelectorAll("[data-kinds]")) {
    part.hidden = !part.dataset.kinds.split(" ").includes(sight.kind.value);
  }
  if (sight.kind.value === "sun_amplitude") {
    sight.height_of_eye_m.closest("label").hidden = sight.horizon.value === "celestial";
  }
  byId("true-label").textContent = sight.kind.value === "quay" ? "True heading by the chart (°)" : "True bearing (°)";
}
function azimuthFault(text) {
  const question = text.startsWith("confirmed: ");
  byId("azimuth-fault").textContent = question ? text.slice("confirmed: ".length) : text;
  byId("azimuth-fault").hidden = text === "";
  if (question) byId("confirm").hidden = false;
}
function observation() {
  const lat = coordinate(sight.lat.value, "N", "S");
  const lon = coordinate(sight.lon.value, "E", "W");
  if (sight.time.value === "") throw new Error("Time: type date and time of the bearing");
  if (Number.isNaN(lat)) throw new Error("Latitude: type it as 43 24.0 N");
  if (Number.isNaN(lon)) throw new Error("Longitude: type it as 003 06.0 W");
  const kind = sight.kind.value;
  const heading = number("compass_heading_deg");
  if (heading == null) throw new Error("Compass heading: it is missing");
  const typed = ["body", "transit", "quay"].includes(kind);
  return {
    // A browser leaves out seconds that are zero.
    kind, time: (sight.time.value + ":00").slice(0, 19) + "Z", lat, lon,
    ...Object.fromEntries(anglesOf.map((name) => [name, number(name)])),
    horizon: kind === "sun_amplitude" ? sight.horizon.value : null,
    name: typed ? sight.name.value : null,
    confirmed: sight.confirmed.checked,
    observer: sight.observer.value, remark: sight.remark.value,
  };
}
async function saveAzimuth(id, azimuth) {
  const response = await alter("PUT", "api/azimuths/" + id, azimuth);
  if (response?.ok) return response.json();
  const text = await response?.text().catch(() => "");
  throw new Error(text || "Nothing was saved.");
}

const errorsOf = (result) => ["compass error " + side(result.compass_error_deg),
  "deviation " + side(result.deviation_deg),
  result.gyro_error_deg == null ? null : "gyro error " + side(result.gyro_error_deg)].filter(Boolean).join(" · ");
const cautionsOf = (result) => result.cautions.map((caution) => capital(cautions[caution] ?? words(caution)) + ".").join(" ");

function closeAzimuth(message) {
  azimuthForm.hidden = true;
  byId("observe").hidden = false;
  byId("observed").textContent = message;
  byId("observe").focus();
}
byId("observe").addEventListener("click", () => {
  const initials = sight.observer.value, eye = sight.height_of_eye_m.value;
  azimuthForm.reset();
  Object.assign(sight.observer, { value: initials });
  Object.assign(sight.height_of_eye_m, { value: eye });
  azimuthId = newId();
  byId("confirm").hidden = true;
  azimuthFault("");
  mark();
  fitAzimuth();
  azimuthForm.hidden = false;
  byId("observe").hidden = true;
  sight.kind.focus();
});
byId("mark").addEventListener("click", mark);
byId("azimuth-cancel").addEventListener("click", () => closeAzimuth(""));
sight.kind.addEventListener("change", fitAzimuth);
sight.horizon.addEventListener("change", fitAzimuth);
azimuthForm.addEventListener("submit", async (event) => {
  event.preventDefault();
  byId("azimuth-send").disabled = true;
  try {
    const saved = await saveAzimuth(azimuthId, observation());
    closeAzimuth(capital(errorsOf(saved.result)) + ". " + cautionsOf(saved.result) +
      " Saved on board; it is sent as soon as there is a link.");
    await refreshAzimuths();
  } catch (error) {
    azimuthFault(error.message);
  }
  byId("azimuth-send").disabled = false;
});

async function withdrawAzimuth(azimuth) {
  if (!confirm("Withdraw this azimuth? It stays in the book's list, struck through, but no longer counts.")) return;
  const { id, written_at, standing, problem, result, ...sent } = azimuth;
  const wrong = await saveAzimuth(id, { ...sent, withdrawn: true }).then(() => "", (error) => error.message);
  byId("observed").textContent = wrong || "Withdrawn.";
  await refreshAzimuths();
}
function showAzimuth(azimuth) {
  const gone = azimuth.withdrawn || azimuth.problem === "withdrawn ashore";
  const facts = element("div");
  const line = element("p");
  line.append(element(gone ? "s" : "span", [second(azimuth.time).replace("T", " "), kinds[azimuth.kind],
    azimuth.name, azimuth.observer].filter(Boolean).join(" · ")));
  facts.append(line);
  const result = azimuth.result;
  if (result) {
    facts.append(element("p", ["true " + degrees(result.true_bearing_deg), errorsOf(result)].join(" · ")));
    if (result.cautions.length > 0) facts.append(element("p", cautionsOf(result), "warn"));
  }
  if (azimuth.remark) facts.append(element("p", azimuth.remark, "note"));
  const tone = { waiting: "warn", ashore: "good", refused: "bad" }[azimuth.standing];
  facts.append(element("p", [azimuth.withdrawn ? "withdrawn" : null, standings[azimuth.standing], azimuth.problem]
    .filter(Boolean).join(": "), tone));
  const item = element("li");
  item.append(facts);
  if (gone) return item;
  const button = element("button", "Withdraw");
  button.type = "button";
  button.setAttribute("aria-label", "Withdraw: " + kinds[azimuth.kind] + ", " + second(azimuth.time).replace("T", " "));
  button.addEventListener("click", () => withdrawAzimuth(azimuth));
  const buttons = element("div", undefined, "buttons");
  buttons.append(button);
  item.append(buttons);
  return item;
}
async function refreshAzimuths() {
  const response = await fetch("api/azimuths", { cache: "no-store" }).catch(() => null);
  const text = response?.ok ? await response.text() : "";
  if (text === "" || text === listedAzimuths) return;
  listedAzimuths = text;
  byId("azimuths").replaceChildren(...JSON.parse(text).map(showAzimuth));
}

refreshAzimuths();
setInterval(refreshAzimuths, 3000);
