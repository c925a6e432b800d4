/**
 * A browser as people know it, from what it says of itself: `Firefox on Windows`.
 * Pure; what is not known stays as it was said.
 */

/** Those that name others beside themselves come first. */
const browsers: [RegExp, string][] = [
  [/\bEdg(?:e|A|iOS)?\//, 'Edge'],
  [/\b(?:OPR|Opera)\//, 'Opera'],
  [/\bVivaldi\//, 'Vivaldi'],
  [/\bSamsungBrowser\//, 'Samsung Internet'],
  [/\b(?:Firefox|FxiOS)\//, 'Firefox'],
  [/\b(?:Chrome|CriOS|HeadlessChrome|Chromium)\//, 'Chrome'],
  [/\bVersion\/\S+.* Safari\//, 'Safari'],
];

const systems: [RegExp, string][] = [
  [/\biPhone\b/, 'an iPhone'],
  [/\biPad\b/, 'an iPad'],
  [/\bAndroid\b/, 'Android'],
  [/\bCrOS\b/, 'ChromeOS'],
  [/\bWindows\b/, 'Windows'],
  [/\bMac(?:intosh| OS X)\b/, 'a Mac'],
  [/\bLinux\b/, 'Linux'],
];

export interface Agent {
  browser: string;
  system: string | undefined;
}

/** The browser and what it runs on; nothing where it is none that is known. */
export function agentOf(said: string): Agent | undefined {
  const named = (known: [RegExp, string][]) => known.find(([words]) => words.test(said))?.[1];
  const browser = named(browsers);
  return browser === undefined ? undefined : { browser, system: named(systems) };
}
