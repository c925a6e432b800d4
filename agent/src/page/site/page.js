"use strict";
const byId = (id) => document.getElementById(id);
const degrees = (value) => value == null ? "–" : value.toFixed(1).padStart(5, "0") + "°";
const side = (value) => value == null ? "–" : Math.abs(value).toFixed(1) + "° " + (value < 0 ? "W" : "E");
const band = (value) => value == null ? "" : " ± " + value.toFixed(1) + "°";
const words = (text) => text.replaceAll("_", " ").replaceAll("-", " ");

// Names come from files and networks: always as text, never as markup.
function element(name, text, className) {
  const made = document.createElement(name);
  if (text !== undefined) made.textContent = text;
  if (className) made.className = className;
  return made;
}
function row(cells) {
  const made = element("tr");
  for (const cell of cells) made.append(cell instanceof Node ? cell : element("td", String(cell)));
  return made;
}
function fact(list, name, text, className) {
  list.push(element("dt", name), element("dd", text, className));
}

function showFacts(status) {
  const facts = [];
  const model = status.model;
  fact(facts, "Model", model == null ? "none" : "version " + model.version + ", data until " +
    model.data_until.slice(0, 16).replace("T", " ") +
    (model.age_days == null ? "" : " (" + model.age_days.toFixed(1) + " days old)") +
    (model.withdrawn ? ": not in use, the compass was altered since then" : ""));
  if (model && model.reference_grade === "course_over_ground") {
    fact(facts, "Reference", "course over ground alone: no gyro or satellite compass checks the deviation", "warn");
  }
  const older = model && !model.withdrawn && model.replaces;
  if (older) {
    fact(facts, "Older cards", "no longer valid: compass altered " + older.since.slice(0, 16).replace("T", " ") +
      " (" + words(older.reason) + ")", "warn");
  }
  const link = status.link;
  fact(facts, "Link to server", words(link.state) + (link.problem ? ": " + link.problem : ""),
    link.state === "up" ? "good" : "warn");
  const spool = status.spool;
  fact(facts, "To send", spool.waiting_batches + " batches, " + spool.pending_samples + " samples not sealed");
  if (status.clock_problem) fact(facts, "Clock", status.clock_problem, "bad");
  if (status.gnss_interference) {
    const since = status.gnss_interference.since;
    fact(facts, "GNSS interference", (since ? "since " + since.slice(0, 16).replace("T", " ") + " UTC: " : "") +
      "position, speed and satellite compass are not used; the heading is corrected for the reckoned place", "bad");
  }
  if (status.storage_problem) fact(facts, "Storage", status.storage_problem, "bad");
  for (const problem of status.source_problems) fact(facts, "Sources", problem, "bad");
  if (spool.parked_batches > 0) {
    fact(facts, "Refused by the server", spool.parked_batches + " batches: " + (spool.parked_because || ""), "bad");
  }
  fact(facts, "Gyro", degrees(status.gyro_deg));
  fact(facts, "Satellite compass", degrees(status.satellite_deg));
  if (status.sog_kn != null) fact(facts, "Speed", status.sog_kn.toFixed(1) + " kn");
  fact(facts, "Ship time", status.ship_time == null ? "not known" : status.ship_time.slice(0, 19).replace("T", " ") + " UTC");
  byId("facts").replaceChildren(...facts);
}

const capital = (text) => text.charAt(0).toUpperCase() + text.slice(1);
// Rewritten only when it changes: a screen reader says it once.
function put(id, text) {
  if (byId(id).textContent !== text) byId(id).textContent = text;
}
function showAlarm(last, difference, interference) {
  const isOpen = last != null && last.state === "open";
  put("alarm-over", last == null || isOpen ? "" : capital(last.says) + ".");
  byId("alarm-over").hidden = last == null || isOpen;
  const all = [isOpen ? last : null, difference && difference.is_open ? difference : null, interference].filter((one) => one != null);
  const alert = all.find((one) => !one.acknowledged) || all[0];
  const open = alert != null;
  alarmId = open ? alert.id : null;
  if (open) {
    const parted = alert.gyro_departure_deg == null ? "Compass and satellite compass have parted" : "Compass and gyro have parted";
    const title = alert === difference ? "Headings differ" : alert === interference ? "GNSS interference" : parted;
    put("alarm-title", title);
    put("alarm-says", capital(alert.says) + ".");
    put("alarm-advice", alert.advice);
    put("alarm-seen", alert.acknowledged ? "Acknowledged" : "Acknowledge");
    byId("alarm-seen").disabled = alert.acknowledged;
    byId("alarm").dataset.seen = String(alert.acknowledged);
  }
  byId("alarm").hidden = !open;
}

function showCard(status) {
  const gone = status.model && status.model.withdrawn;
  const parted = status.alert && status.alert.is_of_the_compass;
  const note = status.card.length > 0 ? (parted ? "Not to be used while the alert is open." : "")
    : gone ? "The last card is no longer valid: steer by gyro or satellite compass, take an azimuth once a watch and on each new course."
    : status.model ? "No card without the position." : "No model yet.";
  put("card-note", note);
  byId("card-note").hidden = note === "";
  byId("card-note").className = parted || gone ? "bad" : "dim";
  const now = status.heading.compass_deg;
  const tables = [];
  for (let start = 0; start < status.card.length; start += 12) {
    const head = row(["Compass", "Deviation", "95 %"].map((text) => element("th", text)));
    const table = element("table");
    table.append(head);
    for (const line of status.card.slice(start, start + 12)) {
      const made = row([degrees(line.compass_deg), side(line.deviation_deg), band(line.band95_deg)]);
      const apart = now == null ? 180 : Math.abs(((now - line.compass_deg + 540) % 360) - 180);
      if (apart <= 7.5) made.className = "now";
      table.append(made);
    }
    tables.push(table);
  }
  byId("card").replaceChildren(...tables);
}

function sourceName(source) {
  return source.input + " " + (source.source ? source.source + " " : source.talker) + source.sentence +
    (source.sfi ? " of " + source.sfi : "") + (source.sender ? " from " + source.sender : "") +
    (source.n2k_address === undefined ? "" : " (" + source.n2k_address + ")");
}

let latest = null; // status
function show(status) {
  latest = status;
  const name = [status.vessel_name, status.compass_name].filter(Boolean).join(" · ");
  shipTime = status.ship_time;
  byId("title").textContent = name || "Compass (not enrolled)";
  showAlarm(status.alert, status.heading_difference, status.gnss_interference);
  const heading = status.heading;
  byId("compass").textContent = degrees(heading.compass_deg);
  byId("magnetic").textContent = degrees(heading.magnetic_deg);
  byId("true").textContent = degrees(heading.true_deg);
  byId("deviation").textContent = "deviation " + side(heading.deviation_deg) + band(heading.band95_deg);
  byId("variation").textContent = "variation " + side(heading.variation_deg);
  const problem = heading.problem ? "Not corrected: " + heading.problem + "." : "";
  if (byId("problem").textContent !== problem) byId("problem").textContent = problem;
  showFacts(status);
  showCurve(status.card, heading.compass_deg);
  showCard(status);
  for (const button of document.querySelectorAll("button[data-hold]")) {
    button.setAttribute("aria-pressed", String(button.dataset.hold === (status.hold || "")));
  }
  byId("inputs").replaceChildren(...status.inputs.map((input) => row([input.name,
    element("td", input.connected ? "connected" : input.problem || "not connected", input.connected ? "good" : "bad"),
    Object.values(input.sentences).reduce((sum, count) => sum + count, 0),
    Object.entries(input.rejected).map(([reason, count]) => count + " " + reason).join(", ") || "–"])));
  byId("sources").replaceChildren(...status.sources.map((source) => row([sourceName(source),
    source.rate_hz == null ? "–" : source.rate_hz.toFixed(1),
    source.last + (source.age_s == null ? " (not yet known to be new)" : source.age_s >= 1 ? " (" + source.age_s.toFixed(0) + " s late)" : ""),
    source.own_output ? "own output" : words(source.serves.join(", ")) ||
      (source.stands_by.length > 0 ? "not used as " + source.stands_by.join(", ") : "–")])));
  byId("windows").replaceChildren(...Object.entries(status.windows).map(([outcome, count]) =>
    row([words(outcome), count])));
}

async function refresh() {
  try {
    const response = await fetch("api/status", { cache: "no-store" });
    if (!response.ok) throw new Error(response.statusText);
    show(await response.json());
  } catch {
    for (const id of ["compass", "magnetic", "true"]) byId(id).textContent = "–";
    byId("problem").textContent = "The agent does not respond.";
  }
}

for (const button of document.querySelectorAll("button[data-hold]")) {
  button.addEventListener("click", async () => {
    byId("held").textContent = await alterOrSay("POST", "api/hold", { hold: button.dataset.hold || null });
    await refresh();
  });
}

let alarmId = null; // of the open alert
byId("alarm-seen").addEventListener("click", async () => {
  const response = await fetch("api/alert/acknowledge", {
    method: "POST",
    headers: { "Content-Type": "application/json", "X-Binnacle-Request": "1" },
    body: JSON.stringify({ id: alarmId }),
  }).catch(() => null);
  if (!response || !response.ok) byId("problem").textContent = "The acknowledgement was not accepted.";
  await refresh();
});

// The other scripts are there then.
document.addEventListener("DOMContentLoaded", () => {
  refresh();
  setInterval(refresh, 1000);
});
