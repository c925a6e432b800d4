/**
 * Drives the built dashboard in a real Chromium against a real server with data.
 *
 * Environment: BINNACLE_URL, BINNACLE_EMAIL, BINNACLE_PASSWORD (an admin whose
 * fleet has at least one vessel with a model), BINNACLE_CHROMIUM (else the
 * system's). Screenshots go to tests/artefacts. Exit code 1 on the first failure.
 */
import { existsSync } from 'node:fs';
import { mkdir } from 'node:fs/promises';
import { fileURLToPath } from 'node:url';
import { chromium } from 'playwright-core';
import { alerts } from './scenarios/alerts.mjs';
import { papers } from './scenarios/papers.mjs';
import { session } from './scenarios/session.mjs';
import { vessel } from './scenarios/vessel.mjs';

/** What a user must be able to do, each in a browser of its own. */
const scenarios = { ...vessel, ...papers, ...alerts, ...session };

const artefacts = fileURLToPath(new URL('../../tests/artefacts/', import.meta.url));

/** Chromium in a container, with nobody to talk to but our server. */
const flags = [
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

function required(name) {
  const value = process.env[name];
  if (value) return value;
  console.error(`e2e: ${name} is not set`);
  process.exit(2);
}

function browserPath() {
  const found = [process.env.BINNACLE_CHROMIUM, '/usr/bin/chromium', '/usr/bin/google-chrome'].find(
    (path) => path && existsSync(path),
  );
  if (found) return found;
  console.error('e2e: no Chromium; set BINNACLE_CHROMIUM (scripts/chromium prints one)');
  process.exit(2);
}

const settings = {
  url: required('BINNACLE_URL').replace(/\/$/, ''),
  email: required('BINNACLE_EMAIL'),
  password: required('BINNACLE_PASSWORD'),
};

await mkdir(artefacts, { recursive: true });
const browser = await chromium.launch({ executablePath: browserPath(), args: flags });
let failed = 0;
try {
  for (const [name, { viewport, colorScheme, allowedErrors = [], run }] of Object.entries(
    scenarios,
  )) {
    const context = await browser.newContext({
      baseURL: settings.url,
      viewport: viewport ?? { width: 1440, height: 900 },
      colorScheme: colorScheme ?? 'light',
    });
    const page = await context.newPage();
    page.setDefaultTimeout(15_000);
    const complaints = [];
    page.on('pageerror', (error) => complaints.push(`page error: ${error.message}`));
    page.on('console', (message) => {
      if (!['error', 'warning'].includes(message.type())) return;
      const line = `${message.text()} (${message.location().url})`;
      if (!allowedErrors.some((allowed) => allowed.test(line))) complaints.push(line);
    });
    page.on('request', (request) => {
      const { origin } = new URL(request.url());
      if (origin !== settings.url) complaints.push(`request to another host: ${origin}`);
    });
    const shoot = (what, options = {}, part = page) =>
      part.screenshot({ path: `${artefacts}browser-${what}.png`, ...options });
    const started = performance.now();
    try {
      await run({ page, context, settings, shoot });
      if (complaints.length > 0)
        throw new Error(`the browser complained:\n  ${complaints.join('\n  ')}`);
      console.log(`ok   ${name} (${Math.round(performance.now() - started)} ms)`);
    } catch (error) {
      failed++;
      await shoot(`failed-${failed}`, { fullPage: true }).catch(() => undefined);
      console.error(
        `FAIL ${name}\n  ${error.message}\n  browser: ${complaints.join('; ') || 'no complaints'}`,
      );
    }
    await context.close();
  }
} finally {
  await browser.close();
}
console.log(`e2e: ${Object.keys(scenarios).length - failed} passed, ${failed} failed`);
process.exitCode = failed > 0 ? 1 : 0;
