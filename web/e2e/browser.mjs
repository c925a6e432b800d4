/** The browser that drives the dashboard, and what it must be told. */
import { existsSync } from 'node:fs';

/** Chromium in a container, with nobody to talk to but our server. */
export const flags = [
  '--headless',
  '--no-sandbox',
  '--disable-gpu',
  '--disable-quic',
  '--no-first-run',
  '--disable-background-networking',
  '--disable-component-update',
  '--disable-sync',
  '--disable-dev-shm-usage',
];

export function required(name) {
  const value = process.env[name];
  if (value) return value;
  console.error(`e2e: ${name} is not set`);
  process.exit(2);
}

export function browserPath() {
  const found = [process.env.BINNACLE_CHROMIUM, '/usr/bin/chromium', '/usr/bin/google-chrome'].find(
    (path) => path && existsSync(path),
  );
  if (found) return found;
  console.error('e2e: no Chromium; set BINNACLE_CHROMIUM (scripts/chromium prints one)');
  process.exit(2);
}
