/** What several scenarios do. */
import assert from 'node:assert/strict';

/** Working time of a firm that can be asked for whatever day and hour the tests run at. */
export const atAnyHour = {
  working_days: ['Mon', 'Tue', 'Wed', 'Thu', 'Fri', 'Sat', 'Sun'],
  first_hour: 0,
  last_hour: 24,
};

export const phone = { width: 390, height: 844 };
/** Chromium reports every 4xx answer in the console; these are asked for. */
export const notSignedIn = /status of 401 .*\/api\/v1\/me\b/;

/** As anyone; `heading` is that of their first page. */
export async function signInAs(page, email, password, heading) {
  await page.goto('/');
  await page.getByLabel('E-mail').fill(email);
  await page.getByLabel('Password').fill(password);
  await page.getByRole('button', { name: 'Sign in' }).click();
  await page.getByRole('heading', { name: heading, level: 1 }).waitFor();
}

export const signIn = (page, { email, password }) => signInAs(page, email, password, 'Fleet');

/** Opens the first vessel of the list that has a model; answers her name. */
export async function openVessel(page) {
  const row = page
    .getByRole('row')
    .filter({ hasText: /\(95 %\)/ })
    .first();
  await row.waitFor();
  const link = row.getByRole('rowheader').getByRole('link');
  const name = await link.innerText();
  await link.click();
  await page.getByRole('heading', { name, level: 1 }).waitFor();
  await drawnInFull(page);
  // It is drawn when it is about to be seen.
  await chart(page).scrollIntoViewIfNeeded();
  await curve(page).waitFor();
  return name;
}

/** Opens the page of a vessel, or one part of it. */
export async function goToVessel(page, id, part = '') {
  await page.goto(`/vessels/${id}${part}`);
  await page.getByRole('heading', { level: 1 }).waitFor();
  await drawnInFull(page);
}

/** Opens the header's menu: on a phone the pages are in it. */
export const openMenu = (page) =>
  page.getByRole('banner').getByRole('button', { name: /Menu$/ }).click();

/** Opens one of the tabs of a vessel's page. */
export async function openTab(page, name) {
  const tabs = page.getByRole('navigation', { name: 'About the vessel' });
  await tabs.getByRole('link', { name, exact: true }).click();
  await tabs.locator('[aria-current=page]', { hasText: name }).waitFor();
  await drawnInFull(page);
}

/**
 * Waits until no part of the page is still loading. Parts are built one after another, and each
 * moves those below it, also while a button there is pressed.
 */
async function drawnInFull(page) {
  await page.waitForFunction(
    () =>
      ![...document.querySelectorAll('main [role=status]')].some(
        (status) => status.textContent.trim() === 'Loading…',
      ),
  );
}

export const chart = (page) => page.getByTestId('deviation-chart');
export const curve = (page) => chart(page).locator('svg [aria-label="line"] path').last();

/** The table has its rows, the map its marks and its coasts. */
export async function fleetIsShown(page) {
  await page.getByRole('rowheader').first().waitFor();
  await page.locator('path.mark[d^="M"]').first().waitFor({ state: 'attached' });
  await page.locator('path.land[d^="M"]').first().waitFor({ state: 'attached' });
}

/** The first vessel that has a model, by the API. */
export async function withModel(page) {
  const listed = await (await page.request.get('/api/v1/vessels')).json();
  return listed.items.find((vessel) => vessel.model);
}

/** The vessel that lightning struck, by the API. */
export async function struck(page) {
  const listed = await (await page.request.get('/api/v1/vessels')).json();
  for (const vessel of listed.items) {
    const answer = await page.request.get(`/api/v1/vessels/${vessel.id}/changes`);
    const { changes } = await answer.json();
    if (changes.some((change) => change.cause === 'lightning_or_shock')) return vessel;
  }
  throw new Error('no vessel was struck by lightning');
}

/** Sets the limits of a vessel's alerts. */
export async function limit(page, id, limits) {
  const path = `/api/v1/vessels/${id}/settings`;
  const found = await (await page.request.get(path)).json();
  const answer = await page.request.put(path, {
    headers: { 'X-Binnacle-Request': '1' },
    data: { ...found, alerts: { band95_deg: 45, ...limits } },
  });
  assert.ok(answer.ok(), await answer.text());
  // Two limits that are judged at once would be one: what was cleared by hand is not raised again.
  await analysed(page);
}

/** Waits until no analysis is queued or under way. */
async function analysed(page) {
  for (let tries = 0; tries < 150; tries += 1) {
    const metrics = await (await page.request.get('/metrics')).text();
    const jobs = [...metrics.matchAll(/^binnacle_jobs\{state="(?:queued|running)"\} (\d+)/gm)];
    assert.equal(jobs.length, 2, metrics);
    if (jobs.every(([, count]) => count === '0')) return;
    await page.waitForTimeout(100);
  }
  assert.fail('the analyses do not end');
}

export async function fitsItsWidth(page) {
  const excess = await page.evaluate(
    () => document.documentElement.scrollWidth - document.documentElement.clientWidth,
  );
  assert.ok(excess <= 0, `the page is ${excess} px wider than the screen`);
}
