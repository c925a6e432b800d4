/** Every page, by day and by night, on a desk and on a phone: axe finds nothing. */
import assert from 'node:assert/strict';
import { findings } from '../axe.mjs';
import {
  chart,
  curve,
  fitsItsWidth,
  notSignedIn,
  phone,
  signIn,
  signInAs,
  withModel,
} from '../helpers.mjs';

/** The latest order there is; made where there is none. */
async function anOrder(vessel, page) {
  const { items } = await (await page.request.get('/api/v1/work-orders')).json();
  if (items.length > 0) return `/work-orders/${items.at(-1).id}`;
  const made = await page.request.post('/api/v1/work-orders', {
    headers: { 'X-Binnacle-Request': '1' },
    data: {
      vessel_id: vessel.id,
      compass_id: vessel.compasses[0].id,
      port: 'Bilbao (ESBIO)',
      planned_at: new Date().toISOString(),
    },
  });
  assert.equal(made.status(), 201, await made.text());
  return `/work-orders/${(await made.json()).id}`;
}

/** Each page, what shows that it is there, and what opens the rest of it. */
const pages = [
  { name: 'fleet', path: '/', ready: (page) => page.getByRole('rowheader').first() },
  { name: 'alerts', path: '/alerts', ready: (page) => page.getByRole('heading', { level: 1 }) },
  { name: 'mail', path: '/mail', ready: (page) => page.getByRole('heading', { level: 1 }) },
  { name: 'webhooks', path: '/webhooks', ready: (page) => page.getByRole('heading', { level: 1 }) },
  { name: 'vessel', path: (vessel) => `/vessels/${vessel.id}`, ready: chart, drawn: curve },
  ...['deviation', 'changes', 'adjustment', 'agent', 'settings'].map((tab) => ({
    name: `vessel-${tab}`,
    path: (vessel) => `/vessels/${vessel.id}/${tab}`,
    ready: (page) => page.locator('main section h2').nth(1),
  })),
  { name: 'schedule', path: '/schedule', ready: (page) => page.getByTestId('timeline') },
  {
    name: 'order',
    path: anOrder,
    ready: (page) => page.getByRole('heading', { level: 2 }).first(),
  },
  { name: 'orders', path: '/work-orders', ready: (page) => page.getByRole('row').first() },
  { name: 'new-order', path: '/work-orders/new', ready: (page) => page.getByLabel('Vessel') },
  { name: 'binnacles', path: '/binnacles', ready: (page) => page.getByTestId('binnacles') },
  {
    name: 'firms',
    path: '/firms',
    ready: (page) => page.getByRole('heading', { level: 3 }).first(),
  },
  { name: 'reports', path: '/reports', ready: (page) => page.getByTestId('report-deviation') },
  {
    name: 'notifications',
    path: '/notifications',
    ready: (page) => page.getByLabel('Time zone'),
  },
  {
    name: 'settings',
    path: '/settings',
    ready: (page) => page.getByText('this browser', { exact: true }),
  },
  { name: 'people', path: '/settings/people', ready: (page) => page.getByTestId('users') },
  { name: 'agents', path: '/settings/agents', ready: (page) => page.getByLabel('Vessel') },
  {
    name: 'schedule-rules',
    path: '/settings/schedule',
    ready: (page) => page.getByRole('slider').first(),
    folded: (page) => page.getByText('Advanced: every figure'),
  },
  { name: 'audit', path: '/settings/audit', ready: (page) => page.getByTestId('audit') },
  {
    name: 'start',
    path: '/start',
    ready: (page) => page.getByTestId('checklist'),
  },
  { name: 'help', path: '/help', ready: (page) => page.getByRole('heading', { level: 1 }) },
  {
    name: 'help-topic',
    path: '/help/alerts',
    ready: (page) => page.getByRole('article').getByRole('heading').first(),
  },
  { name: 'nothing', path: '/no-such', ready: (page) => page.getByRole('heading', { level: 1 }) },
];

/** Goes to a page and opens what is folded there. */
async function open(page, { path, ready, folded }, vessel) {
  await page.goto(typeof path === 'string' ? path : await path(vessel, page));
  await ready(page).waitFor();
  await folded?.(page).click();
}

async function each({ page, settings, shoot }, look) {
  const found = [];
  await page.goto('/');
  await page.getByLabel('E-mail').waitFor();
  found.push(...(await findings(page)).map((line) => `sign in: ${line}`));
  await page.getByRole('button', { name: 'Forgot your password?' }).click();
  await page.getByRole('button', { name: 'Send the link' }).waitFor();
  found.push(...(await findings(page)).map((line) => `forgotten password: ${line}`));
  await shoot(`page-forgotten-password-${look}`);
  // As an empty server answers, which another group sets up for good.
  await page.route('**/api/v1/first-run', (asked) => asked.fulfill({ json: { open: true } }));
  await page.goto('/');
  await page.getByLabel('Set-up code').waitFor();
  found.push(...(await findings(page)).map((line) => `first run: ${line}`));
  await shoot(`page-first-run-${look}`);
  await page.unroute('**/api/v1/first-run');
  await signIn(page, settings);
  const vessel = await withModel(page);
  for (const one of pages) {
    const { name, drawn } = one;
    await open(page, one, vessel);
    // Charts are drawn when they are near, or for paper.
    await page.evaluate(() => dispatchEvent(new Event('beforeprint')));
    await drawn?.(page).waitFor();
    await page.evaluate(() => dispatchEvent(new Event('afterprint')));
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

/** An adjuster's pages and the platform's; their addresses, and what shows that they are there. */
const others = [
  {
    who: 'adjuster',
    home: 'My orders',
    paths: [
      '/',
      '/work-orders',
      '/settings',
      '/notifications',
      '/settings/keys',
      '/settings/audit',
    ],
  },
  { who: 'platform', home: 'Platform', paths: ['/', '/settings'] },
];

/** Chromium's remark when the worker takes over between two loads that follow at once. */
const unusedPreload = /cross-world service worker resource mismatch/;

async function eachOf({ page, settings, shoot }, { who, home, paths }, look) {
  const found = [];
  await signInAs(page, settings[who], settings.password, home);
  for (const path of paths) {
    await page.goto(path);
    await page.getByRole('heading', { level: 1 }).waitFor();
    await page.waitForTimeout(400);
    found.push(...(await findings(page)).map((line) => `${who} ${path}: ${line}`));
    await fitsItsWidth(page);
    await shoot(`page-${who}${path.replaceAll('/', '-')}-${look}`, { fullPage: true });
  }
  assert.deepEqual(found, []);
}

/** From the narrowest phone to a wall, beside each width at which a page is laid out anew. */
const widths = [
  320, 390, 480, 640, 641, 760, 768, 900, 1024, 1099, 1150, 1230, 1231, 1440, 1920, 2800, 3840,
];

/** Two frames after, what is measured has been drawn. */
const drawn = (page) =>
  page.evaluate(
    () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))),
  );

async function noneScrolls({ page, settings }) {
  await signIn(page, settings);
  const vessel = await withModel(page);
  const wide = [];
  for (const one of pages) {
    await open(page, one, vessel);
    for (const width of widths) {
      await page.setViewportSize({ width, height: 900 });
      await drawn(page);
      await fitsItsWidth(page).catch(({ message }) =>
        wide.push(`${one.name} at ${width}: ${message}`),
      );
    }
  }
  assert.deepEqual(wide, []);
}

export const access = {
  'no page scrolls sideways, from 320 to 3840 pixels': {
    allowedErrors: [notSignedIn],
    run: noneScrolls,
  },
  ...Object.fromEntries(
    looks.flatMap(({ look, ...screen }) => [
      [
        `axe finds nothing on any page, ${look.replace('-', ' by ')}`,
        {
          ...screen,
          allowedErrors: [notSignedIn, unusedPreload],
          run: (tools) => each(tools, look),
        },
      ],
      ...others.map((other) => [
        `axe finds nothing on the ${other.who}’s pages, ${look.replace('-', ' by ')}`,
        {
          ...screen,
          allowedErrors: [notSignedIn, unusedPreload],
          run: (tools) => eachOf(tools, other, look),
        },
      ]),
    ]),
  ),
};
