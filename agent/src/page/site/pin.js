"use strict";
// Changes: sent with the PIN where one is set, which is forgotten ten minutes after its last use.
const PIN_KEPT_MS = 10 * 60 * 1000;
const pinDialog = document.getElementById("pin-dialog");
const pinForm = document.getElementById("pin-form");
let access = { pin: false, allowed: true };
let pin = null;
let forgetting = null; // timer

function keepPin(typed) {
  pin = typed;
  clearTimeout(forgetting);
  if (typed != null) forgetting = setTimeout(() => keepPin(null), PIN_KEPT_MS);
  document.getElementById("forget").hidden = typed == null;
}
// Asks for the PIN, and resolves to it, or to null.
function askPin(problem) {
  document.getElementById("pin-problem").textContent = problem;
  pinForm.reset();
  pinDialog.showModal();
  return new Promise((resolve) => {
    pinForm.onsubmit = (event) => {
      event.preventDefault();
      pinDialog.onclose = null;
      pinDialog.close();
      resolve(pinForm.elements.pin.value.trim());
    };
    pinDialog.onclose = () => resolve(null);
  });
}
// Sends a change. Resolves to the response; to null where there is none, or the officer gives up.
async function alter(method, url, body) {
  let asked = pin == null && access.pin ? await askPin("") : pin;
  if (access.pin && asked == null) return null;
  for (;;) {
    const headers = { "Content-Type": "application/json", "X-Binnacle-Request": "1" };
    if (asked != null) headers["X-Binnacle-Pin"] = asked;
    const response = await fetch(url, { method, headers, body: JSON.stringify(body) }).catch(() => null);
    if (response?.status === 401) {
      keepPin(null);
      await refreshAccess();
      asked = await askPin(asked == null ? "" : "The PIN is wrong.");
      if (asked == null) return null;
      continue;
    }
    if (response?.ok && asked != null) keepPin(asked);
    refreshActions();
    return response;
  }
}
// Sends a change. Resolves to the reason why it failed, or to an empty text.
async function alterOrSay(method, url, body) {
  const response = await alter(method, url, body);
  if (response?.ok) return "";
  return (await response?.text().catch(() => "")) || "Nothing was changed.";
}

async function refreshAccess() {
  const response = await fetch("api/access", { cache: "no-store" }).catch(() => null);
  if (!response?.ok) return;
  access = await response.json();
  const said = access.pin ? "Changes need the PIN of this page."
    : access.allowed ? "No PIN is set: changes are accepted on this computer alone."
    : "No PIN is set: changes are accepted on the agent's own computer alone.";
  document.getElementById("access").textContent = said;
  document.getElementById("changes").disabled = !access.allowed;
}
async function refreshActions() {
  if (!document.getElementById("actions-shown").open) return;
  const response = await fetch("api/actions", { cache: "no-store" }).catch(() => null);
  if (!response?.ok) return;
  const actions = await response.json();
  const rows = actions.map((one) => {
    const line = document.createElement("tr");
    for (const text of [one.at.slice(0, 19).replace("T", " "), one.action, one.result, one.address]) {
      const cell = document.createElement("td");
      cell.textContent = text;
      line.append(cell);
    }
    return line;
  });
  document.getElementById("actions").replaceChildren(...rows);
}

document.getElementById("forget").addEventListener("click", () => keepPin(null));
document.getElementById("pin-cancel").addEventListener("click", () => pinDialog.close());
document.getElementById("actions-shown").addEventListener("toggle", refreshActions);
refreshAccess();
setInterval(refreshAccess, 30000);
