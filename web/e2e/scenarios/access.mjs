/** Every page, by day and by night, on a desk and on a phone: axe finds nothing. */
import assert from 'node:assert/strict';
import { findings } from '../axe.mjs';
import { curve, fitsItsWidth, notSignedIn, phone, signIn, withModel } from '../helpers.mjs';

/** Each page, and what shows that it is there. */
const pages = [
  { name: 'fleet', path: '/', ready: (page) => page.getByRole('rowheader').first() },
  { name: 'alerts', path: '/alerts', ready: (page) => page.getByRole('heading', { level: 1 }) },
  { name: 'mail', path: '/mail', ready: (page) => page.getByRole('heading', { level: 1 }) },
  { name: 'webhooks', path: '/webhooks', ready: (page) => page.getByRole('heading', { level: 1 }) },
  { name: 'vessel', path: (vessel) => `/vessels/${vessel.id}`, ready: curve },
  { name: 'nothing', path: '/no-such', ready: (page) => page.getByRole('heading', { level: 1 }) },
];

async function each({ page, settings, shoot }, look) {
  const found = [];
  await page.goto('/');
  await page.getByLabel('E-mail').waitFor();
  found.push(...(await findings(page)).map((line) => `sign in: ${line}`));
  await signIn(page, settings);
  const vessel = await withModel(page);
  for (const { name, path, ready } of pages) {
    await page.goto(typeof path === 'string' ? path : path(vessel));
    await ready(page).waitFor();
    await page.waitForTimeout(400);
    found.push(...(await findings(page)).map((line) => `${name}: ${line}`));
    await fitsItsWidth(page);
    await shoot(`page-${name}-${look}`, { fullPage: true });
  }
  assert.deepEqual(found, []);
}

const looks = [
  { look: 'desk-day', colorScheme: 'light' },
  { look: 'desk-night', colorScheme: 'dark' },
  { look: 'phone-day', colorScheme: 'light', viewport: phone },
  { look: 'phone-night', colorScheme: 'dark', viewport: phone },
];

export const access = Object.fromEntries(
  looks.map(({ look, ...screen }) => [
    `axe finds nothing on any page, ${look.replace('-', ' by ')}`,
    {
      ...screen,
      allowedErrors: [notSignedIn],
      run: (tools) => each(tools, look),
    },
  ]),
);
