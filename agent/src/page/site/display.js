"use strict";
// Day, dusk or night, and the dimmer: kept by the browser, and set before the page is drawn.
const display = { mode: "dusk", light: 100 };
try {
  Object.assign(display, JSON.parse(localStorage.getItem("binnacle-display")));
} catch {
  // Without a store, or with a damaged one, the page begins as usual.
}
function showDisplay() {
  document.documentElement.dataset.mode = display.mode;
  document.documentElement.style.setProperty("--light", String(display.light / 100));
  for (const button of document.querySelectorAll("button[data-mode]")) {
    button.setAttribute("aria-pressed", String(button.dataset.mode === display.mode));
  }
}
function keepDisplay(change) {
  Object.assign(display, change);
  showDisplay();
  try {
    localStorage.setItem("binnacle-display", JSON.stringify(display));
  } catch {
    // It holds until the page is closed.
  }
}
showDisplay();
document.addEventListener("DOMContentLoaded", () => {
  showDisplay();
  for (const button of document.querySelectorAll("button[data-mode]")) {
    button.addEventListener("click", () => keepDisplay({ mode: button.dataset.mode }));
  }
  const dimmer = document.getElementById("dimmer");
  dimmer.value = display.light;
  dimmer.addEventListener("input", () => keepDisplay({ light: Number(dimmer.value) }));
});
