"use strict";
// The logbook. Times are typed and shown in UTC.
const form = byId("form");
const fields = form.elements;
const names = Object.fromEntries([...fields.kind.options, ...fields.cargo.options].map((o) => [o.value, o.text]));
const lasting = { magnetic_cargo: ["Loaded", "Discharged"], berth: ["Alongside from", "Sailed"] };
const standings = { waiting: "waiting for the link", ashore: "delivered", refused: "refused" };
let shipTime = null;
let editing = null; // the report in the form, as it was; null for a new one
let listed = "";

// A unique id, also where the page is not served over TLS.
function newId() {
  const bytes = crypto.getRandomValues(new Uint8Array(16));
  bytes[6] = (bytes[6] & 15) | 64; bytes[8] = (bytes[8] & 63) | 128;
  const hex = Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");
  return hex.replace(/^(.{8})(.{4})(.{4})(.{4})/, "$1-$2-$3-$4-");
}
const minute = (time) => time == null ? "" : new Date(time).toISOString().slice(0, 16);
// A field shows minutes: where it was not touched, the report keeps its seconds.
const instant = (typed, was) => typed === "" ? null : minute(was) === typed ? was : typed + ":00Z";
const shown = (time) => minute(time).replace("T", " ");

function openForm(report, ended) {
  form.reset();
  editing = report ?? { id: newId(), isNew: true };
  fields.kind.value = editing.kind ?? "magnetic_cargo";
  fields.from.value = minute(editing.from ?? shipTime ?? new Date());
  fields.to.value = minute(ended ? shipTime ?? new Date() : editing.to);
  fields.cargo.value = editing.cargo ?? "steel";
  for (const name of ["hatch", "port", "note", "reporter"]) fields[name].value = editing[name] ?? "";
  byId("send").textContent = editing.isNew ? "Report" : "Save";
  byId("fault").hidden = true;
  byId("report").hidden = true;
  form.hidden = false;
  fitForm();
  (ended ? fields.to : fields.kind).focus();
}
function closeForm(message) {
  form.hidden = true;
  byId("report").hidden = false;
  byId("reported").textContent = message;
  byId("report").focus();
}
function fitForm() {
  const [from, to] = lasting[fields.kind.value] ?? ["When", "Until"];
  byId("from-label").textContent = from;
  byId("to-label").textContent = to;
  for (const label of form.querySelectorAll("[data-cargo]")) label.hidden = fields.kind.value !== "magnetic_cargo";
}
function fault(text) {
  byId("fault").textContent = text;
  byId("fault").hidden = false;
}
// Sends a report to the agent, which stores it. Returns the error, or an empty text.
function save(id, report) {
  return alterOrSay("PUT", "api/reports/" + id, report);
}

fields.kind.addEventListener("change", fitForm);
byId("report").addEventListener("click", () => openForm());
byId("cancel").addEventListener("click", () => closeForm(""));
form.addEventListener("submit", async (event) => {
  event.preventDefault();
  const cargo = fields.kind.value === "magnetic_cargo";
  byId("send").disabled = true;
  const wrong = await save(editing.id, {
    kind: fields.kind.value,
    from: instant(fields.from.value, editing.from),
    to: instant(fields.to.value, editing.to),
    cargo: cargo ? fields.cargo.value : null,
    hatch: cargo ? fields.hatch.value : null,
    port: fields.port.value,
    note: fields.note.value,
    reporter: fields.reporter.value,
  });
  byId("send").disabled = false;
  if (wrong) return fault(wrong);
  closeForm("Saved on board; it is sent as soon as there is a link.");
  await refreshReports();
});

async function withdraw(report) {
  if (!confirm("Withdraw this report? It stays in the logbook, struck through, but no longer counts.")) return;
  const { kind, from, to, cargo, hatch, port, note, reporter } = report;
  const wrong = await save(report.id, { kind, from, to, cargo, hatch, port, note, reporter, withdrawn: true });
  byId("reported").textContent = wrong || "Withdrawn.";
  await refreshReports();
}

function showReport(report) {
  const gone = report.withdrawn || report.problem === "withdrawn ashore";
  const words = element("div");
  const what = [names[report.cargo], report.hatch && "hatch " + report.hatch, report.port].filter(Boolean);
  const line = element("p");
  line.append(element(gone ? "s" : "span", [shown(report.from) + (report.to ? " – " + shown(report.to) : ""),
    names[report.kind], ...what].join(" · ")));
  words.append(line);
  if (report.note) words.append(element("p", report.note, "note"));
  const tone = { waiting: "warn", ashore: "good", refused: "bad" }[report.standing];
  words.append(element("p", [report.withdrawn ? "withdrawn" : null, standings[report.standing], report.problem]
    .filter(Boolean).join(": "), tone));
  const item = element("li");
  item.append(words);
  if (gone) return item;
  const buttons = element("div", undefined, "buttons");
  const button = (text, act) => {
    const made = element("button", text);
    made.type = "button";
    made.setAttribute("aria-label", text + ": " + names[report.kind] + ", " + shown(report.from));
    made.addEventListener("click", act);
    buttons.append(made);
  };
  if (lasting[report.kind] && report.to == null) button(lasting[report.kind][1] + "…", () => openForm(report, true));
  button("Change", () => openForm(report));
  button("Withdraw", () => withdraw(report));
  item.append(buttons);
  return item;
}

async function refreshReports() {
  const response = await fetch("api/reports", { cache: "no-store" }).catch(() => null);
  const text = response?.ok ? await response.text() : "";
  // Redrawn only after a change: a button must not vanish under a finger.
  if (text === "" || text === listed) return;
  listed = text;
  byId("reports").replaceChildren(...JSON.parse(text).map(showReport));
}

refreshReports();
setInterval(refreshReports, 3000);
