/**
 * Drives the built dashboard in a real Chromium against a real server with data.
 *
 * Environment: BINNACLE_URL, BINNACLE_EMAIL, BINNACLE_PASSWORD (an admin whose
 * fleet has at least one vessel with a model), BINNACLE_ADJUSTER (the e-mail of one of
 * a firm that works for it, with the same password), BINNACLE_PLATFORM (the e-mail of who
 * runs the platform, with the same password), BINNACLE_OIDC_ISSUER (a provider by whose word
 * the admin may sign in) with BINNACLE_PUBLIC_URL (where the provider sends people back to),
 * BINNACLE_EMPTY_URL (a server without a user) with BINNACLE_SETUP_CODE (its set-up code),
 * BINNACLE_CHROMIUM (else the system's). Screenshots go to tests/artefacts. Exit code 1 on the first failure.
 */
import { mkdir } from 'node:fs/promises';
import { fileURLToPath } from 'node:url';
import { chromium } from 'playwright-core';
import { browserPath, flags, required } from './browser.mjs';
import { access } from './scenarios/access.mjs';
import { adjusting } from './scenarios/adjusting.mjs';
import { alerts } from './scenarios/alerts.mjs';
import { azimuths } from './scenarios/azimuths.mjs';
import { begin } from './scenarios/begin.mjs';
import { fleet } from './scenarios/fleet.mjs';
import { link } from './scenarios/link.mjs';
import { live } from './scenarios/live.mjs';
import { papers } from './scenarios/papers.mjs';
import { people } from './scenarios/people.mjs';
import { platform } from './scenarios/platform.mjs';
import { schedule } from './scenarios/schedule.mjs';
import { session } from './scenarios/session.mjs';
import { spanish } from './scenarios/spanish.mjs';
import { told } from './scenarios/told.mjs';
import { vessel } from './scenarios/vessel.mjs';

/** What a user must be able to do, each in a browser of its own; later ones of a group
 * go on where earlier ones ended. */
const groups = {
  begin,
  fleet,
  link,
  vessel,
  azimuths,
  papers,
  alerts,
  session,
  live,
  adjusting,
  schedule,
  people,
  platform,
  told,
  access,
  spanish,
};

const artefacts = fileURLToPath(new URL('../../tests/artefacts/', import.meta.url));

const settings = {
  artefacts,
  url: required('BINNACLE_URL').replace(/\/$/, ''),
  email: required('BINNACLE_EMAIL'),
  password: required('BINNACLE_PASSWORD'),
  adjuster: process.env.BINNACLE_ADJUSTER,
  platform: process.env.BINNACLE_PLATFORM,
  issuer: process.env.BINNACLE_OIDC_ISSUER,
  publicUrl: process.env.BINNACLE_PUBLIC_URL,
  emptyUrl: process.env.BINNACLE_EMPTY_URL,
  setupCode: process.env.BINNACLE_SETUP_CODE,
};

/** All of them, those of a group, or those with the words in their names: `npm run e2e -- fleet`. */
const words = process.argv.slice(2).join(' ');
const chosen = Object.entries(groups).flatMap(([group, scenarios]) =>
  Object.entries(scenarios).filter(([name]) => group === words || name.includes(words)),
);

if (chosen.length === 0) throw new Error(`there is no group "${words}", nor a scenario with it`);

await mkdir(artefacts, { recursive: true });
const browser = await chromium.launch({ executablePath: browserPath(), args: flags });
let failed = 0;
try {
  for (const [name, scenario] of chosen) {
    const {
      viewport,
      colorScheme,
      locale,
      serviceWorkers,
      allowedErrors = [],
      hosts,
      run,
    } = scenario;
    const known = [settings.url, ...(hosts?.(settings) ?? [])];
    const context = await browser.newContext({
      baseURL: settings.url,
      viewport: viewport ?? { width: 1440, height: 900 },
      colorScheme: colorScheme ?? 'light',
      locale: locale ?? 'en-US',
      serviceWorkers: serviceWorkers ?? 'allow',
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
      if (!known.includes(origin)) complaints.push(`request to another host: ${origin}`);
    });
    const shoot = (what, options = {}, part = page) =>
      part.screenshot({ path: `${artefacts}browser-${what}.png`, ...options });
    const started = performance.now();
    try {
      await run({ page, context, browser, settings, shoot });
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
console.log(`e2e: ${chosen.length - failed} passed, ${failed} failed`);
process.exitCode = failed > 0 ? 1 : 0;
