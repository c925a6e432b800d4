/** The deviation card and the deviation book. */
import assert from 'node:assert/strict';
import {
  phone,
  notSignedIn,
  signIn,
  goToVessel,
  openTab,
  openVessel,
  fitsItsWidth,
} from '../helpers.mjs';

/** A card that is refused is a 409 in the console. */
const refused = /status of 409 .*\/card\.json/;

const cardOf = (page) => page.getByRole('region', { name: 'Deviation card' });
const bookOf = (page) => page.getByRole('region', { name: 'Deviation book' });

/** What a link leads to, with the browser's own session. */
async function fetched(page, link) {
  const answer = await page.request.get(await link.getAttribute('href'));
  assert.equal(answer.status(), 200, await link.innerText());
  return answer;
}

export const papers = {
  'a card is made, seen, and printed': {
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      await openVessel(page);
      await openTab(page, 'Deviation');
      const card = cardOf(page);
      await card.getByRole('button', { name: 'Make the card' }).click();
      const made = card.getByTestId('card');
      await made
        .getByText(/For \d\d° \d\d\.\d′ [NS],[^]*By model \d+, to ± \d\.\d° or better/)
        .waitFor();
      await made.getByText(/adjuster, licence and firm; an adjuster’s signature/).waitFor();
      const picture = made.getByRole('img');
      await picture.scrollIntoViewIfNeeded();
      await page.waitForFunction((image) => image.naturalWidth > 0, await picture.elementHandle());
      const pdf = await fetched(page, made.getByRole('link', { name: 'Print (PDF)' }));
      assert.equal(pdf.headers()['content-type'], 'application/pdf');
      assert.equal((await pdf.body()).subarray(0, 5).toString(), '%PDF-');
      const svg = await (await fetched(page, made.getByRole('link', { name: /SVG/ }))).text();
      assert.match(svg, /PREDICTED – NOT A CERTIFICATE/);
      const csv = await (await fetched(page, made.getByRole('link', { name: /CSV/ }))).text();
      assert.equal(csv.trim().split('\n').length, 25);
      await fitsItsWidth(page);
      await shoot('card', {}, card);
    },
  },

  'where the model is too uncertain there is no card but a reason': {
    allowedErrors: [notSignedIn, refused],
    async run({ page, settings }) {
      await signIn(page, settings);
      await openVessel(page);
      await openTab(page, 'Deviation');
      await page.getByRole('button', { name: 'Choose another place' }).click();
      await page.getByLabel('Latitude', { exact: true }).fill('48 S');
      await page.getByLabel('Longitude').fill('020 E');
      await page.getByRole('button', { name: 'Show', exact: true }).click();
      const card = cardOf(page);
      await card.getByText('For the place and day chosen above').waitFor();
      await card.getByRole('button', { name: 'Make the card' }).click();
      const reason = card.getByRole('alert');
      await reason.getByText('No card can be made now').waitFor();
      assert.match(await reason.innerText(), /known only to ±|no model|days before the card/);
      assert.equal(await card.getByRole('img').count(), 0);
    },
  },

  'a card that an open alert stands against leads to the alert, and says what cures it': {
    allowedErrors: [notSignedIn, refused],
    async run({ page, settings }) {
      await signIn(page, settings);
      const answer = await page.request.get('/api/v1/vessels');
      const vessel = (await answer.json()).items.find((one) => one.model);
      const id = '01a207db-e6c9-706b-9c95-e21e8fa17d76';
      const listed = await (await page.request.get('/api/v1/alerts?open=true')).json();
      const alert = {
        ...listed.items[0],
        ...{ id, vessel_id: vessel.id, vessel_name: vessel.name },
        ...{ compass_id: vessel.compasses[0].id, cause: 'reported_aboard', severity: 'warning' },
        ...{ summary: 'Compass and gyro parted.', advice: 'Keep comparing them each watch.' },
      };
      const items = [...listed.items, alert];
      await page.route('**/api/v1/alerts?open=true*', (route) =>
        route.fulfill({ json: { items, next: null } }),
      );
      await page.route('**/card.json*', (route) =>
        route.fulfill({
          status: 409,
          contentType: 'application/problem+json',
          body: JSON.stringify({
            type: '/problems/compass-suspected',
            status: 409,
            detail: `an alert on this compass is open: ${alert.summary}`,
          }),
        }),
      );
      await goToVessel(page, vessel.id);
      const needs = page.getByRole('region', { name: 'Needs' });
      await needs.locator(`a[href="/alerts#${id}"]`).waitFor();
      await openTab(page, 'Deviation');
      const card = cardOf(page);
      await card.scrollIntoViewIfNeeded();
      await card.getByRole('button', { name: 'Make the card' }).click();
      await card.getByText('Keep comparing them each watch.').waitFor();
      await card.getByRole('link', { name: 'The alert' }).click();
      await page.getByRole('heading', { name: 'Alerts', level: 1 }).waitFor();
      const named = page.locator(`[id="${id}"]`);
      await named.getByText('Compass and gyro parted.').waitFor();
      await page.waitForFunction((wanted) => document.activeElement?.id === wanted, id);
    },
  },

  'the deviation book is printed for the days chosen, on a phone too': {
    viewport: phone,
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      await openVessel(page);
      await openTab(page, 'Deviation');
      const book = bookOf(page);
      const whole = await (await fetched(page, book.getByRole('link', { name: /CSV/ }))).text();
      const times = whole
        .trim()
        .split('\n')
        .slice(1)
        .map((line) => line.slice(0, 10));
      assert.ok(times.length > 20, `${times.length} entries`);
      const day = times[Math.floor(times.length / 2)];
      await book.getByLabel('First day').fill(day);
      await book.getByLabel('Last day').fill(day);
      const one = await (await fetched(page, book.getByRole('link', { name: /CSV/ }))).text();
      const within = one
        .trim()
        .split('\n')
        .slice(1)
        .map((line) => line.slice(0, 10));
      assert.deepEqual(
        within,
        times.filter((time) => time === day),
      );
      const pdf = await fetched(page, book.getByRole('link', { name: 'Print (PDF)' }));
      assert.equal(pdf.headers()['content-type'], 'application/pdf');
      await book.getByLabel('Last day').fill('2020-01-01');
      await book.getByRole('alert').getByText('The last day is before the first').waitFor();
      await fitsItsWidth(page);
      await shoot('book-phone', {}, book);
    },
  },
};
