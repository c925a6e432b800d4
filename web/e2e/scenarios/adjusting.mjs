/**
 * An adjustment: the binnacle entered, the order written, the work at the binnacle on a
 * phone with the connection cut, and the evidence.
 */
import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import {
  phone,
  notSignedIn,
  signIn,
  goToVessel,
  openMenu,
  openTab,
  struck,
  chart,
  curve,
  fitsItsWidth,
} from '../helpers.mjs';

/** The berth where she is adjusted, a day from her last sample at most, and how she lies. */
const berth = { lat: 35.9, lon: 14.5, headingDeg: 40 };
/** The share of the earth's field that reaches the compass: what no heading tells. */
const lambda = 0.9;
const radians = (degrees) => (degrees * Math.PI) / 180;
const degrees = (radians) => (radians * 180) / Math.PI;

/** Without a connection every call fails, and the browser says so. */
const cut = /ERR_INTERNET_DISCONNECTED/;

/** The vessel to whom nothing happened. */
async function calm(page) {
  const { id } = await struck(page);
  const listed = await (await page.request.get('/api/v1/vessels')).json();
  return listed.items.find((vessel) => vessel.model && vessel.id !== id);
}

/** What a good magnetometer reads aboard her, µT, and what her compass reads, degrees. */
async function fieldAtBerth(page, vessel) {
  const get = async (path) => (await page.request.get(`/api/v1/vessels/${vessel}/${path}`)).json();
  const { parameters_over_lambda: p } = (await get('model')).model;
  const at = new Date().toISOString();
  const here = await get(`deviation?lat=${berth.lat}&lon=${berth.lon}&at=${at}`);
  const magnetic = radians(berth.headingDeg - here.variation_deg);
  const [hx, hy, z] = [here.h_nt * Math.cos(magnetic), -here.h_nt * Math.sin(magnetic), here.z_nt];
  const d = p.chi11_minus_chi22 / 2;
  const forward = lambda * ((1 + d) * hx + p.chi12 * hy + p.chi13 * z + p.bx_nt);
  const starboard = lambda * (p.chi21 * hx + (1 - d) * hy + p.chi23 * z + p.by_nt);
  return {
    forward: (forward / 1000).toFixed(2),
    starboard: (starboard / 1000).toFixed(2),
    compass: ((degrees(Math.atan2(-starboard, forward)) + 360) % 360).toFixed(1),
  };
}

/** Says by the API that she calls there tomorrow. */
async function callAtBerth(page, vessel) {
  const at = (days) => new Date(Date.now() + days * 86_400_000).toISOString();
  const answer = await page.request.post(`/api/v1/vessels/${vessel}/port-calls`, {
    headers: { 'X-Binnacle-Request': '1' },
    data: { port: 'MTMLA', eta: at(1), etd: at(3), berth: 'A5' },
  });
  assert.ok(answer.ok(), await answer.text());
}

async function orderOf(page, vessel) {
  const listed = await (await page.request.get(`/api/v1/work-orders?vessel=${vessel.id}`)).json();
  return listed.items[0];
}

const expected = async (page) => parseFloat(await page.getByTestId('expected').innerText());

/** Reads the compass after a step as it should stand, and goes on. */
async function stepAsExpected(page, n) {
  await page.getByText(new RegExp(`^Step ${n} of`)).waitFor();
  await page.getByLabel(/^The compass reads/).fill(String(await expected(page)));
  await page.getByText(/^Off by 0\.\d°, within what readings err\.$/).waitFor();
  await page.getByRole('button', { name: 'Done: next' }).click();
}

export const adjusting = {
  'a compass is put in its binnacle, and an adjustment ordered': {
    allowedErrors: [notSignedIn, /status of 422 .*\/binnacle/],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      const vessel = await calm(page);
      await page.getByRole('link', { name: 'Work orders' }).click();
      await page.getByRole('heading', { name: 'Work orders', level: 1 }).waitFor();
      await page.getByText('No adjustment is under way').waitFor();
      await callAtBerth(page, vessel.id);
      await page.getByRole('link', { name: 'Order an adjustment' }).click();
      await page.getByLabel('Vessel').selectOption(vessel.id);
      await page.getByText('its binnacle, with the correctors on board').waitFor();
      await page.getByRole('link', { name: 'Put it in' }).click();

      const panel = page.getByRole('region', { name: 'Binnacle and correctors' });
      await panel.getByRole('button', { name: 'Choose a binnacle' }).click();
      await panel.getByLabel('Type').selectOption('class_a_trays');
      await panel.getByLabel('Magnets, 200 mm').fill('12');
      await panel.getByLabel('Magnets, heeling 150 mm').fill('2');
      await panel.getByLabel('Pieces of the Flinders bar').fill('300, 150, 75, 75');
      for (const size of ['5 inch', '7 inch']) {
        await panel.getByLabel(size, { exact: true }).check();
      }
      await panel.getByRole('button', { name: /Put magnets in.*Fore-and-aft/ }).click();
      await panel.getByLabel('Tray at hole').selectOption('5');
      await panel.getByLabel('Red end').first().selectOption('aft');
      const save = panel.getByRole('button', { name: 'Save the binnacle' });
      await save.click();
      await panel.getByRole('alert').getByText('serial number').waitFor();
      await panel.getByLabel('Serial number').fill('2047');
      await shoot('binnacle-form', {}, panel);
      await save.click();
      await panel.getByText(/^Revision 1, .* by Test Officer/).waitFor();
      await panel.getByText('tray at hole 5, 1 magnet, 200 mm, red end AFT').waitFor();
      const file = await page.request.get(
        await panel.getByRole('link', { name: 'Export JSON' }).getAttribute('href'),
      );
      await panel.getByLabel('Import JSON').setInputFiles({
        name: 'other.json',
        mimeType: 'application/json',
        buffer: Buffer.from('[]'),
      });
      await panel.getByRole('alert').getByText('This file is not a binnacle').waitFor();
      await panel.getByLabel('Import JSON').setInputFiles({
        name: 'binnacle.json',
        mimeType: 'application/json',
        buffer: await file.body(),
      });
      await panel.getByText('From the file binnacle.json').waitFor();
      await save.click();
      await panel.getByText(/^Revision 1, /).waitFor();

      await openTab(page, 'Settings');
      const particulars = page.getByRole('region', { name: 'Particulars' });
      await particulars.getByRole('button', { name: /Amend… Compass/ }).click();
      await particulars.getByLabel('Maker and type').fill('Reflecta 1');
      await particulars.getByRole('button', { name: 'Save' }).click();
      await particulars.getByText('Reflecta 1').waitFor();

      await openTab(page, 'Adjustment');
      const orders = page.getByRole('region', { name: 'Adjustment' });
      await orders.getByRole('link', { name: 'Order an adjustment' }).click();
      const order = page.getByRole('button', { name: 'Order it' });
      await order.click();
      await page.getByRole('alert').getByText('Say in which port').waitFor();
      assert.equal(await page.getByLabel('Vessel').inputValue(), vessel.id);
      // Her call tells where and when; who can do it there comes first.
      await page.getByRole('radio', { name: /^Valletta \(MTMLA\)/ }).check();
      assert.equal(await page.getByLabel('Berth (optional)').inputValue(), 'A5');
      await page.getByText(/^There: .* UTC\+1$/).waitFor();
      const can = page.getByRole('group', { name: 'Who adjusts' });
      await can.getByText('2 firms cannot do it there and then: why').waitFor();
      await can.getByText('Maas Compass: No terms are said.').waitFor();
      await fitsItsWidth(page);
      await shoot('order-new', { fullPage: true });
      await can.getByRole('radio', { name: 'Someone else, by name' }).check();
      await page.getByLabel('Adjuster').fill('M. Etxeberria');
      await page.getByLabel('Licence number').fill('ES-CA-114');
      await order.click();
      await page.getByRole('heading', { name: `${vessel.name}: adjustment`, level: 1 }).waitFor();
      await page.getByText('Next: the adjuster reads the magnetic field').waitFor();
      const ready = page.getByRole('region', { name: 'Before the berth' });
      await ready.getByText(/A model of the compass, its last sample .*: there/).waitFor();
      await ready.getByText('correctors on board : there').waitFor();
      await fitsItsWidth(page);
      await shoot('order', { fullPage: true });
      await page.getByRole('link', { name: 'All work orders' }).click();
      await page.getByRole('row').filter({ hasText: vessel.name }).getByText('Planned').waitFor();
      await shoot('orders');
    },
  },

  'the fleet’s binnacles say which compass has none, and lead to where it is entered': {
    // Who has none may have no model either.
    allowedErrors: [notSignedIn, /status of 404 .*\/(model|deviation)\b/],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      const entered = await calm(page);
      await page.getByRole('link', { name: 'Binnacles', exact: true }).click();
      await page.getByRole('heading', { name: 'Binnacles', level: 1 }).waitFor();
      const table = page.getByTestId('binnacles');
      const hers = table.getByRole('row').filter({ hasText: entered.name });
      await hers.getByText('No. 2047').waitFor();
      await hers.getByText('12 magnets, 200 mm').waitFor();
      await hers.getByText(/^revision 1, by Test Officer/).waitFor();
      await page.getByText(/ not entered yet: no adjustment of /).waitFor();
      const first = table.getByRole('row').nth(1);
      await first.getByText('not entered').waitFor();
      await fitsItsWidth(page);
      await shoot('binnacles', { fullPage: true });

      await page.getByLabel('Search').fill('2047');
      assert.equal(await table.getByRole('rowheader').count(), 1);
      await page.getByLabel('Search').fill('no such');
      await page.getByText('No binnacle fits').waitFor();
      await page.getByLabel('Search').fill('');
      const name = await first.getByRole('rowheader').getByRole('link').innerText();
      await first.getByRole('link', { name: /^Enter it: the binnacle of / }).click();
      await page.getByRole('heading', { name, level: 1 }).waitFor();
      const panel = page.getByRole('region', { name: 'Binnacle and correctors' });
      await panel.getByText('The binnacle of this compass is not entered yet').waitFor();
    },
  },

  'at the binnacle a phone goes on without a connection, and loses nothing': {
    viewport: phone,
    allowedErrors: [notSignedIn, cut, /status of 422 .*\/berth-reading/],
    async run({ page, context, settings, shoot }) {
      await signIn(page, settings);
      const vessel = await calm(page);
      const { id, compass_id } = await orderOf(page, vessel);
      const field = await fieldAtBerth(page, vessel.id);
      // The page is kept by the browser from now on.
      await page.evaluate(() => navigator.serviceWorker.ready.then(() => undefined));
      await page.goto(`/work-orders/${id}`);

      // Each corrector is looked at before anything is planned.
      await page.getByRole('heading', { name: 'How it was found' }).waitFor();
      const confirm = page.getByRole('button', { name: 'This is how it was found' });
      await confirm.waitFor();
      const drawn = await page.request.get(
        `/api/v1/vessels/${vessel.id}/compasses/${compass_id}/binnacle/revisions?limit=1`,
      );
      assert.equal(drawn.status(), 200, await drawn.text());
      const [{ binnacle }] = (await drawn.json()).items;
      const { fore_and_aft, athwartship, ...iron } = binnacle.setting;
      const fitted = [...(fore_and_aft ?? []), ...(athwartship ?? [])].concat(
        Object.values(iron).filter(Boolean),
      );
      const last = page.getByTestId('seen').nth(fitted.length - 1);
      if (fitted.length > 0) await last.waitFor();
      const lines = await page.getByTestId('seen').all();
      assert.equal(lines.length, fitted.length);
      if (lines.length > 0) {
        await confirm.click();
        await page.getByText('Tick each corrector that you have looked at').waitFor();
      }
      const look = async () => {
        for (const line of await page.getByTestId('seen').all()) await line.check();
        const turned = page.getByLabel(/^Turn each Kelvin sphere/);
        if ((await turned.count()) > 0) await turned.fill('0.5');
      };
      await look();
      await fitsItsWidth(page);
      await shoot('berth-found-phone', { fullPage: true });
      // A defective compass is repaired, and reported again.
      await page.getByLabel(/^Pivot/).selectOption('defective');
      await confirm.click();
      await page.getByText('To be repaired before planning').waitFor();
      await look();
      await page.getByLabel(/^Pivot/).selectOption('sound');
      await confirm.click();
      await page.getByRole('heading', { name: 'Read the field' }).waitFor();

      // In gauss what is microtesla: refused, with what it could be.
      await page.getByLabel('Latitude').fill('35 54.0 N');
      await page.getByLabel('Longitude').fill('014 30.0 E');
      await page.getByLabel(/^True heading of the ship/).fill(String(berth.headingDeg));
      await page.getByLabel('It is from').selectOption('ashore');
      await page.getByLabel(/^The compass read, before/).fill(field.compass);
      await page.getByLabel('Unit of the magnetometer').selectOption('gauss');
      await page.getByLabel(/^Forward/).fill(field.forward);
      await page.getByLabel(/^Starboard/).fill(field.starboard);
      await page.getByText('stronger than any ship’s field').waitFor();
      await fitsItsWidth(page);
      await shoot('berth-reading-phone', { fullPage: true });
      await page.getByRole('button', { name: 'Send the reading' }).click();
      const refused = page.getByTestId('refused');
      const couldBe = 'the figures are in microtesla (1 microtesla is 1000 nT)';
      await refused.getByText(couldBe, { exact: true }).waitFor();
      await refused.getByText('What would cure it').waitFor();
      await shoot('berth-refused-phone');
      assert.equal(await page.getByLabel(/^Forward/).inputValue(), field.forward);
      await page.getByLabel('Unit of the magnetometer').selectOption('microtesla');
      await page.getByRole('button', { name: 'Send the reading' }).click();

      await page.getByRole('heading', { name: 'Choose a plan' }).waitFor();
      const plan = page.getByTestId('plan').first();
      await plan.getByText('recommended').waitFor();
      await fitsItsWidth(page);
      await shoot('berth-plans-phone', { fullPage: true });
      await plan.getByRole('button', { name: /Work by this plan/ }).click();

      const step = page.getByTestId('step');
      await step.getByText(/^Step 1 of \d$/).waitFor();
      const steps = Number((await step.getByText(/^Step 1 of/).innerText()).at(-1));
      assert.ok(steps >= 2, `${steps} steps`);
      assert.match(await page.getByTestId('expected').innerText(), /^\d{3}\.\d°$/);
      await fitsItsWidth(page);
      await shoot('berth-step-phone', { fullPage: true });
      await page.getByLabel(/^The compass reads/).fill('200');
      await page.getByText(/^Off by \d+\.\d°\. Read once more/).waitFor();

      await context.setOffline(true);
      await stepAsExpected(page, 1);
      const waiting = page.getByTestId('waiting');
      await waiting.getByText('1 thing is waiting to be sent').waitFor();
      await waiting.getByText('It is kept in this browser').waitFor();
      await step.getByText(`Step 2 of ${steps}`).waitFor();
      // From its top, though the button that led here is far below it.
      const onScreen = (part) =>
        page.waitForFunction((element) => {
          const { top, bottom } = element.getBoundingClientRect();
          return top >= 0 && bottom <= innerHeight;
        }, part);
      await onScreen(await step.getByText(`Step 2 of ${steps}`).elementHandle());
      await onScreen(await waiting.elementHandle());
      assert.equal(
        await page.evaluate(() => document.activeElement?.getAttribute('data-testid')),
        'task-step',
      );
      await page.getByLabel(/^The compass reads/).fill('12.3');
      await shoot('berth-offline-phone', { fullPage: true });
      // Neither what is typed nor what waits is lost with the page.
      await page.reload();
      await waiting.getByText('1 thing is waiting to be sent').waitFor();
      await step.getByText(`Step 2 of ${steps}`).waitFor();
      assert.equal(await page.getByLabel(/^The compass reads/).inputValue(), '12.3');
      for (let n = 2; n <= steps; n++) await stepAsExpected(page, n);

      await page.getByRole('heading', { name: 'Complete and sign' }).waitFor();
      await page.getByText('Photographs, remarks').click();
      await page.getByLabel('What the record should have').fill('Crane alongside until noon');
      await page.getByRole('button', { name: 'Add it' }).last().click();
      const picture = await page.screenshot();
      await page
        .getByLabel('Take or choose a photograph')
        .setInputFiles({ name: 'tray.png', mimeType: 'image/png', buffer: picture });
      await page.getByLabel('What it shows').fill('Trays as they stand');
      await page.getByRole('button', { name: 'Add it' }).first().click();
      await waiting.getByText(`${steps + 2} things are waiting to be sent`).waitFor();

      // The field once more: as though nothing had been done, then as it was foretold.
      await context.setOffline(false);
      await waiting.waitFor({ state: 'detached', timeout: 60_000 });
      const again = page.getByRole('region', { name: 'Read the field once more' });
      await again.locator('summary').click();
      const sendField = async (forward, starboard) => {
        await again.getByLabel(/^Forward/).fill(forward);
        await again.getByLabel(/^Starboard/).fill(starboard);
        await again.getByRole('button', { name: 'Send what it reads' }).click();
      };
      const sign = page.getByRole('button', { name: 'Sign and complete' });
      await sign.waitFor();
      await sendField(field.forward, field.starboard);
      await again.getByRole('alert').waitFor();
      await sign.waitFor({ state: 'detached' });
      await fitsItsWidth(page);
      await shoot('berth-again-phone', { fullPage: true });
      await again.getByRole('button', { name: 'I have looked: they stand as planned' }).click();
      await again.getByText('It is noted that they were looked at since').waitFor();
      await sign.waitFor({ state: 'detached' });
      const foretold = async (part) =>
        (await again.getByTestId(`foretold-${part}`).innerText()).replace(/\s*µT/, '');
      await sendField(await foretold(0), await foretold(1));
      await again.getByText('The field agrees with what was foretold, within its error').waitFor();
      await sign.waitFor();
      await fitsItsWidth(page);
      await context.setOffline(true);
      await page.getByLabel('Type your name once more').fill('somebody else');
      await sign.click();
      await page.getByRole('alert').getByText('The signature is not the name above').waitFor();
      await page.getByLabel('Type your name once more').fill('M. Etxeberria');
      await fitsItsWidth(page);
      await shoot('berth-finish-phone', { fullPage: true });
      await sign.click();
      await page.getByText('The completion is signed and waiting to be sent').waitFor();

      await context.setOffline(false);
      await waiting.waitFor({ state: 'detached', timeout: 60_000 });
      await page.getByRole('heading', { name: 'Adjusted, to be verified' }).waitFor();
      await shoot('berth-done-phone');
      const done = await (await page.request.get(`/api/v1/work-orders/${id}`)).json();
      assert.equal(done.state, 'adjusted');
      assert.equal(done.steps_done, steps);
      assert.equal(done.photos.length, 1);
      const log = await (await page.request.get(`/api/v1/work-orders/${id}/entries`)).json();
      const kinds = log.items.map((line) => line.entry.kind);
      assert.equal(kinds.filter((kind) => kind === 'step').length, steps, 'each step once');
      assert.deepEqual(kinds.slice(-6), [
        'remark',
        'photo',
        'second_reading',
        'corrector_settings',
        'second_reading',
        'completion',
      ]);
      assert.equal(done.second_reading.verdict, 'as_planned');
    },
  },

  'an operator and a firm agree on terms, and write to each other': {
    allowedErrors: [notSignedIn],
    async run({ page, context, settings, shoot }) {
      await signIn(page, settings);
      const { id, name } = await struck(page);
      await page.goto(`/work-orders/new?vessel=${id}`);
      await page.getByText('No port call of hers is known.').waitFor();
      await page.getByLabel('Port', { exact: true }).fill('Valletta');
      await page.getByRole('button', { name: 'Order it' }).click();
      const title = { name: `${name}: adjustment`, level: 1 };
      await page.getByRole('heading', title).waitFor();
      const firms = page.getByRole('region', { name: 'Firms' });
      await firms.getByRole('button', { name: 'Offer it to firms' }).click();
      const submit = firms.getByRole('button', { name: 'Offer it', exact: true });
      await firms.getByLabel('Ibaizabal Compass').waitFor();
      await submit.click();
      await firms.getByRole('alert').getByText('Choose a firm').waitFor();
      await firms.getByLabel('Ibaizabal Compass').check();
      await firms.getByLabel('What is said to them').fill('Gangway to port');
      await shoot('order-offer', {}, firms);
      await submit.click();
      await firms.getByText(/^Ibaizabal Compass: asked, answer due by /).waitFor();
      await page.getByText('Ibaizabal Compass was asked').waitFor();
      await fitsItsWidth(page);

      // The firm's adjuster, on a phone of their own.
      const faults = [];
      const theirs = await context.browser().newContext({
        baseURL: settings.url,
        viewport: phone,
      });
      try {
        const other = await theirs.newPage();
        other.setDefaultTimeout(15_000);
        other.on('pageerror', (error) => faults.push(error.message));
        await other.goto('/');
        await other.getByLabel('E-mail').fill(settings.adjuster);
        await other.getByLabel('Password').fill(settings.password);
        await other.getByRole('button', { name: 'Sign in' }).click();
        await openMenu(other);
        await other.getByRole('link', { name: 'Work orders' }).click();
        await other.getByRole('row').filter({ hasText: name }).getByRole('link').click();
        await other.getByRole('heading', title).waitFor();
        const asked = other.getByRole('region', { name: 'Firms' });
        await asked.getByText('it is offered to your firm').waitFor();
        await asked.getByText('Gangway to port').waitFor();
        await other.getByText('not shown to your firm').waitFor();
        await asked.getByRole('button', { name: 'Propose other terms' }).click();
        await asked.getByLabel('Fee in euros').fill('a lot');
        await asked.getByRole('button', { name: 'Propose it' }).click();
        await asked.getByRole('alert').getByText('A fee is a figure').waitFor();
        await asked.getByLabel('Fee in euros').fill('900');
        await fitsItsWidth(other);
        await other.screenshot({
          path: `${settings.artefacts}browser-firm-proposes-phone.png`,
          fullPage: true,
        });
        await asked.getByRole('button', { name: 'Propose it' }).click();
        await asked.getByText('the operator has not answered yet').waitFor();
        const chat = other.getByRole('region', { name: 'Messages' });
        await chat.getByLabel('Message').fill('Is there a pilot ladder?');
        await chat.getByRole('button', { name: 'Send' }).click();
        await chat.getByText('Is there a pilot ladder?').waitFor();

        // The operator's page hears of it by itself.
        await firms.getByText('€ 900').waitFor();
        const messages = page.getByRole('region', { name: 'Messages' });
        await messages.getByText('Is there a pilot ladder?').waitFor();
        await messages.getByLabel('Message').fill('A gangway; the mate meets you.');
        await messages.getByRole('button', { name: 'Send' }).click();
        await shoot('order-proposed', { fullPage: true });
        await firms.getByRole('button', { name: /^Agree to what Ibaizabal Compass/ }).click();
        await firms.getByText(/^Ibaizabal Compass: has it/).waitFor();

        await asked.getByText('your firm has it').waitFor();
        await chat.getByText('A gangway; the mate meets you.').waitFor();
        await other.getByRole('group', { name: 'Show' }).getByText('At the binnacle').click();
        const sent = other.waitForResponse((answer) => answer.url().endsWith('/on-board'));
        await other.getByRole('button', { name: 'I am on board' }).click();
        await other.getByRole('heading', { name: 'Read the field' }).waitFor();
        // The page goes on before it is sent; this one is closed soon.
        await sent;
        await fitsItsWidth(other);
        await other.screenshot({ path: `${settings.artefacts}browser-firm-on-board-phone.png` });
      } finally {
        await theirs.close();
      }
      assert.deepEqual(faults, []);
      await page.getByText('Adjuster on board').first().waitFor();
      await page.getByRole('button', { name: 'Cancel the order…' }).click();
      await page.getByLabel('Why it is not to be done').fill('A test');
      await page.getByRole('button', { name: 'Cancel the order', exact: true }).click();
      await page.getByText('Cancelled').first().waitFor();
    },
  },

  'a superintendent sees plan, proof and evidence of it, by night too': {
    colorScheme: 'dark',
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      const vessel = await calm(page);
      await page.goto('/work-orders');
      await page.getByRole('row').filter({ hasText: vessel.name }).getByRole('link').click();
      await page.getByText('No settled heading has come in since').waitFor();
      const plan = page.getByRole('region', { name: 'Plan', exact: true });
      await plan
        .getByText(/^Foretold at worst \d\.\d° on \d{3}°; with its band \d\.\d°\.$/)
        .waitFor();
      const drawing = plan.getByTestId('plan-chart');
      await drawing.scrollIntoViewIfNeeded();
      await drawing.locator('svg [aria-label="line"] path').nth(1).waitFor();
      await plan.locator('summary', { hasText: 'Foretold on each heading' }).click();
      assert.equal(await plan.getByTestId('predicted-table').locator('tbody tr').count(), 24);
      await page.getByText('predicted, not a certificate').first().waitFor();
      const papers = page.getByRole('region', { name: 'Record and evidence' });
      await papers.getByText('Completed by M. Etxeberria, licence ES-CA-114').waitFor();
      const image = papers.getByRole('img', { name: 'Trays as they stand' });
      await image.scrollIntoViewIfNeeded();
      await page.waitForFunction((img) => img.naturalWidth > 0, await image.elementHandle());
      const [download] = await Promise.all([
        page.waitForEvent('download'),
        papers.getByTestId('evidence').click(),
      ]);
      const archive = await readFile(await download.path());
      assert.equal(archive.subarray(0, 2).toString(), 'PK');
      assert.ok(archive.includes('record.json') && archive.includes('record.pdf'));
      const log = page.getByRole('region', { name: 'Log' });
      await log.getByText('Crane alongside until noon').waitFor();
      assert.match(await log.innerText(), /refused: .*\n?/);
      await fitsItsWidth(page);
      await shoot('order-done', { fullPage: true });
      await page.setViewportSize(phone);
      await fitsItsWidth(page);
      await shoot('order-done-phone', { fullPage: true });
    },
  },

  'her curve is shown as predicted, with no sample of before the adjustment': {
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      const vessel = await calm(page);
      await goToVessel(page, vessel.id);
      await page.getByText(/^none: foretold by work order .*, fitted to no sample$/).waitFor();
      await openTab(page, 'Deviation');
      const deviation = page.getByRole('region', { name: 'Deviation', exact: true });
      const said = deviation.getByTestId('foretold');
      await said.getByText('Predicted, not verified at sea').waitFor();
      await said.getByText('No settled heading has come in since the adjustment.').waitFor();
      await said.getByRole('link', { name: 'The order' }).waitFor();
      await deviation.getByText('Samples from before the adjustment are not drawn').waitFor();
      await curve(page).waitFor();
      assert.equal(await chart(page).getAttribute('data-dots'), '0');
      assert.equal(await chart(page).locator('svg .dots path[d^="M"]').count(), 0);
      await page
        .getByRole('heading', { name: /^Table of deviations, predicted, not ver/ })
        .waitFor();
      const trust = page.getByRole('region', { name: 'How far to trust the curve' });
      await trust.scrollIntoViewIfNeeded();
      await trust.getByText('Predicted, not verified at sea').waitFor();
      assert.doesNotMatch(await trust.innerText(), /independent errors|Only one/);
      await fitsItsWidth(page);
      await shoot('vessel-foretold', { fullPage: true });
      await openTab(page, 'Changes');
      const changes = page.getByRole('region', { name: 'What changed' });
      await changes.getByText('Its curve is foretold by the adjustment').waitFor();
      await page.setViewportSize(phone);
      await fitsItsWidth(page);
    },
  },
};
