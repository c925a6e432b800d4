/** The schedule: calls entered, the plan made, a job pinned, dragged and offered. */
import assert from 'node:assert/strict';
import { findings } from '../axe.mjs';
import {
  atAnyHour,
  fitsItsWidth,
  limit,
  notSignedIn,
  phone,
  signIn,
  goToVessel,
  signInAs,
  struck,
} from '../helpers.mjs';

const hourMs = 3_600_000;
const dayMs = 24 * hourMs;
const written = { headers: { 'X-Binnacle-Request': '1' } };
const iso = (at) => new Date(at).toISOString();

/** The Monday after next: far enough for every lead time. */
function monday() {
  const midnight = Math.floor(Date.now() / dayMs) * dayMs;
  return midnight + (15 - ((new Date(midnight).getUTCDay() + 6) % 7)) * dayMs - dayMs;
}

async function good(answer) {
  const { ok, text } = await answer.then(async (a) => ({ ok: a.ok(), text: await a.text() }));
  assert.ok(ok, text);
  return text === '' ? null : JSON.parse(text);
}

/** Terms of two firms, the cheaper of which serves Rotterdam only; `more` is added to both. */
async function firmsHaveTerms(page, more = {}) {
  const { items } = await good(page.request.get('/api/v1/firms'));
  assert.ok(items.length >= 2, 'the operator works with no two firms');
  const ports = [
    [{ port: 'NLRTM', travel_eur: 100 }],
    [
      { port: 'NLRTM', travel_eur: 150 },
      { port: 'BEANR', travel_eur: 400 },
    ],
  ];
  for (const [n, firm] of items.slice(0, 2).entries()) {
    const data = { fee_eur: 1800 + 100 * n, ports: ports[n], ...more };
    await good(page.request.put(`/api/v1/firms/${firm.id}/terms`, { ...written, data }));
  }
}

/**
 * What rules ask about her, that her deviation is within her limit, and that she was adjusted
 * so that she is due in forty days.
 */
async function due(page, vessel) {
  const path = `/api/v1/vessels/${vessel.id}`;
  const known = { flag_state: 'NO', gross_tonnage: 24000, trade: 'bulk', deviation_record: 'kept' };
  await good(page.request.put(`${path}/particulars`, { ...written, data: known }));
  await limit(page, vessel.id, { deviation_deg: 45 });
  const before = new Date(Date.now() + 40 * dayMs);
  before.setUTCFullYear(before.getUTCFullYear() - 2);
  const adjusted = { kind: 'adjustment', from: before.toISOString() };
  await good(page.request.post(`${path}/logbook`, { ...written, data: adjusted }));
}

/** A call of the vessel to whom nothing happened, and an order at it, offered to a firm. */
async function offered(page) {
  const { id: hit } = await struck(page);
  const { items } = await good(page.request.get('/api/v1/vessels'));
  const vessel = items.find((one) => one.model && one.id !== hit);
  const from = monday() + 21 * dayMs + 6 * hourMs;
  const data = { port: 'NLRTM', eta: iso(from), etd: iso(from + 36 * hourMs) };
  const calls = `/api/v1/vessels/${vessel.id}/port-calls`;
  const { id } = await good(page.request.post(calls, { ...written, data }));
  const firms = await good(page.request.get('/api/v1/firms'));
  const order = await good(
    page.request.post('/api/v1/work-orders', {
      ...written,
      data: {
        vessel_id: vessel.id,
        compass_id: vessel.compasses[0].id,
        port: 'NLRTM',
        planned_at: iso(from + 2 * hourMs),
        offer: { firms: [firms.items.find((firm) => firm.name === 'Ibaizabal Compass').id] },
      },
    }),
  );
  return { call: { path: `${calls}/${id}`, from }, order: order.id, name: vessel.name };
}

const jobs = (page) => page.getByTestId('jobs').locator('tbody tr');
const solve = (page) => page.getByRole('button', { name: /^(Update plan|Make the plan)$/ });

export const schedule = {
  'port calls are entered by hand and from a file, and the schedule is solved': {
    allowedErrors: [notSignedIn, /status of 422 .*port-calls\.csv/],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      const hit = await struck(page);
      await firmsHaveTerms(page);
      await due(page, hit);
      await page.getByRole('link', { name: 'Schedule', exact: true }).click();
      await page.getByRole('heading', { name: 'Schedule', level: 1 }).waitFor();
      const calls = page.getByRole('region', { name: 'Port calls' });
      await calls.getByLabel('Vessel').selectOption(hit.id);
      await calls.getByRole('button', { name: 'Enter it' }).click();
      await calls.getByRole('alert').getByText('Choose a port').waitFor();
      await calls.getByLabel('Port', { exact: true }).fill('NLRTM');
      await calls.getByText('Times are the port’s, Europe/Amsterdam.').waitFor();
      await calls.getByLabel('Arrives').fill(iso(monday() + dayMs / 4).slice(0, 16));
      await calls.getByLabel('Leaves').fill(iso(monday() + 2.5 * dayMs).slice(0, 16));
      await calls.getByRole('button', { name: 'Enter it' }).click();
      await calls.getByText('The call is entered.').waitFor();

      const file = (text) => ({
        name: 'calls.csv',
        mimeType: 'text/csv',
        buffer: Buffer.from(text),
      });
      const head = 'id,vessel,port,eta,etd\n';
      const [eta, etd] = [iso(monday() + 7 * dayMs), iso(monday() + 9 * dayMs)];
      await calls
        .getByLabel('File, .csv or .ics')
        .setInputFiles(file(`${head}b1,${hit.name},BEANR,${eta},soon\n`));
      await calls.getByRole('button', { name: 'Send the file' }).click();
      await calls
        .getByRole('alert')
        .getByText(/line 2/)
        .waitFor();
      await calls
        .getByLabel('File, .csv or .ics')
        .setInputFiles(file(`${head}b1,${hit.name},BEANR,${eta},${etd}\n`));
      await calls.getByRole('button', { name: 'Send the file' }).click();
      await calls.getByText('1 new, 0 changed, 0 as before, 0 withdrawn.').waitFor();

      await solve(page).click();
      const job = jobs(page).filter({ hasText: hit.name });
      await job.getByText('Rotterdam').waitFor();
      await job.getByText('Proposed').waitFor();
      await page.getByTestId('timeline').getByRole('button', { name: hit.name }).waitFor();
      await fitsItsWidth(page);
      await shoot('schedule', { fullPage: true });

      // From her own page the way leads to the job that is proposed for her.
      await goToVessel(page, hit.id);
      await page
        .getByTestId('needs')
        .getByRole('link', { name: /^Proposed: .* Rotterdam/ })
        .click();
      await page.locator('#job').getByRole('heading', { name: hit.name }).waitFor();
      await page.waitForFunction(() => document.activeElement?.closest('#job'));
    },
  },

  'a job is dragged to another call and pinned, and it is said what that costs': {
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      const hit = await struck(page);
      await page.goto('/schedule');
      const block = page.getByTestId('timeline').getByRole('button', { name: hit.name });
      await block.scrollIntoViewIfNeeded();
      const box = await block.boundingBox();
      const track = await page.getByTestId('timeline').locator('li .track').first().boundingBox();
      const week = (track.width / 91) * 7;
      const y = box.y + box.height / 2;
      await page.mouse.move(box.x + box.width / 2, y);
      await page.mouse.down();
      await page.mouse.move(box.x + box.width / 2 + week / 2, y, { steps: 4 });
      await page.mouse.move(box.x + box.width / 2 + week, y, { steps: 4 });
      await shoot('schedule-dragging');
      await page.mouse.up();
      const panel = page.locator('#job');
      assert.match(
        await panel.getByLabel('Port call').locator('option:checked').innerText(),
        /^Antwerp/,
      );
      await panel.getByRole('combobox', { name: 'Firm' }).selectOption({ index: 1 });
      await panel.getByLabel(/^Why/).fill('Agreed by telephone');
      await shoot('schedule-job', {}, panel);
      await panel.getByRole('button', { name: 'Pin and update plan' }).click();
      const changes = page.getByRole('region', { name: 'What changed' });
      await changes.getByTestId('changes').getByText('Moved').waitFor();
      await changes.getByText(/costs €.* more by your weights/).waitFor();
      const job = jobs(page).filter({ hasText: hit.name });
      await job.getByText(/pinned/).waitFor();
      await job.getByText('Antwerp').waitFor();
      await page
        .locator('#job')
        .getByText(/^Pinned by Test Officer/)
        .waitFor();
      await shoot('schedule-changed', { fullPage: true });
    },
  },

  'with the keyboard alone a pin is let go, on a phone': {
    viewport: phone,
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      const hit = await struck(page);
      await page.goto('/schedule');
      const block = page.getByTestId('timeline').getByRole('button', { name: hit.name });
      await block.focus();
      await page.keyboard.press('Enter');
      const letGo = page.getByRole('button', { name: 'Let it go where it is best' });
      await letGo.focus();
      await page.keyboard.press('Enter');
      await page.getByTestId('changes').getByText('Moved').waitFor();
      await jobs(page).filter({ hasText: hit.name }).getByText('Rotterdam').waitFor();
      await fitsItsWidth(page);
      await shoot('schedule-phone', { fullPage: true });
    },
  },

  'the month is a calendar for the keyboard, and a list of days on a phone': {
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      const hit = await struck(page);
      await page.goto('/schedule');
      await page.getByText('Calendar', { exact: true }).click();
      const month = page.getByTestId('month');
      const first = await month.getAttribute('aria-label');
      await month.locator('td[tabindex="0"]').focus();
      const day = iso(monday()).slice(0, 10);
      for (
        let at = iso(Date.now()).slice(0, 10);
        at < day;
        at = iso(Date.parse(at) + dayMs).slice(0, 10)
      ) {
        await page.keyboard.press('ArrowRight');
      }
      const list = page.getByTestId('day');
      await list.getByText('In Rotterdam from').waitFor();
      assert.match(
        await month.locator('td[tabindex="0"]').getAttribute('aria-label'),
        /1 vessel in port/,
      );
      await fitsItsWidth(page);
      await shoot('schedule-month', {}, page.locator('#line'));
      await page.keyboard.press('PageDown');
      await page.keyboard.press('PageDown');
      assert.notEqual(await month.getAttribute('aria-label'), first);
      await page.keyboard.press('PageUp');
      await page.keyboard.press('PageUp');
      await page.setViewportSize(phone);
      await page.getByTestId('agenda').getByText(`${hit.name}: job at`).first().click();
      await page.locator('#job').waitFor();
      await fitsItsWidth(page);
      await shoot('schedule-agenda', {}, page.locator('#line'));
    },
  },

  'a planned job is offered to its firm': {
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      const hit = await struck(page);
      await page.goto('/schedule');
      await jobs(page).filter({ hasText: hit.name }).getByRole('button').click();
      const panel = page.locator('#job');
      await panel.getByRole('button', { name: 'Offer it' }).click();
      await jobs(page).filter({ hasText: hit.name }).getByText('Offered').waitFor();
      await panel.getByRole('link', { name: 'See the order' }).waitFor();
      await shoot('schedule-offered', {}, panel);
    },
  },

  'a fee and another time are agreed on, and both sides see that the call has moved': {
    allowedErrors: [notSignedIn],
    async run({ page, context, settings, shoot }) {
      await signIn(page, settings);
      await firmsHaveTerms(page, atAnyHour);
      const { call, order, name } = await offered(page);
      await page.goto(`/work-orders/${order}`);
      await page.getByRole('heading', { name: `${name}: adjustment`, level: 1 }).waitFor();
      const firms = page.getByRole('region', { name: 'Firms' });
      await firms.getByText(/^Offered at € 1.?800, travel not counted$/).waitFor();

      // The firm's adjuster, on a phone of their own.
      const theirs = await context.browser().newContext({ baseURL: settings.url, viewport: phone });
      const faults = [];
      try {
        const other = await theirs.newPage();
        other.setDefaultTimeout(15_000);
        other.on('pageerror', (error) => faults.push(error.message));
        await signInAs(other, settings.adjuster, settings.password, 'My orders');
        await other.goto(`/work-orders/${order}`);
        const overview = other.getByRole('group', { name: 'Show' }).getByText('Overview');
        const asked = other.getByRole('region', { name: 'Firms' });
        await asked.getByText(/^Offered at € 1.?800/).waitFor();
        await asked.getByRole('button', { name: 'Propose other terms' }).click();
        await asked.getByRole('button', { name: 'Propose it' }).click();
        await asked.getByRole('alert').getByText('Say another time').waitFor();
        await asked.getByLabel('Fee in euros').fill('2100,50');
        await asked.getByRole('button', { name: 'Propose it' }).click();
        await asked.getByText('the operator has not answered yet').waitFor();

        await firms.getByText(/^€ 2.?100\.50$/).waitFor();
        await shoot('order-fee-proposed', {}, firms);
        await firms.getByRole('button', { name: /^Agree to what/ }).click();
        await firms.getByText(/: has it/).waitFor();
        await page.getByText(/^The terms of .* were accepted$/).waitFor();

        // She is two days late: both pages hear of it by themselves.
        const day = call.from + 2 * dayMs;
        const late = { eta: iso(day), etd: iso(day + 36 * hourMs) };
        await good(page.request.patch(call.path, { ...written, data: late }));
        await page.getByTestId('call').getByText('agree on a new day').waitFor();
        if (await overview.isVisible()) await overview.click();
        await other.getByTestId('call').getByText('agree on a new day').waitFor();
        await fitsItsWidth(other);
        const list = await context.newPage();
        await list.goto('/work-orders');
        const row = list.getByRole('row').filter({ hasText: 'Call moved: needs a new day' });
        await row.getByText(name).waitFor();
        await list.close();

        // What is asked for may be taken back, and asked again.
        await firms.getByRole('button', { name: 'Ask for another time…' }).click();
        await firms.getByLabel('Hours for an answer').fill('0');
        await firms.getByRole('button', { name: 'Ask the firm' }).click();
        await firms.getByRole('alert').getByText('1 to 720').waitFor();
        await firms.getByLabel('Hours for an answer').fill('24');
        await firms.getByLabel('A word to them').fill('She is two days late.');
        await firms.getByRole('button', { name: 'Ask the firm' }).click();
        const question = firms.getByRole('region', { name: 'Another time is asked for' });
        await question.getByRole('button', { name: 'Take the question back' }).click();
        await question.waitFor({ state: 'detached' });
        await firms.getByRole('button', { name: 'Ask for another time…' }).click();
        await firms.getByRole('button', { name: 'Ask the firm' }).click();
        await question.waitFor();
        assert.deepEqual(await findings(page), []);
        await shoot('order-retime', { fullPage: true });

        const put = asked.getByRole('region', { name: 'Another time is asked for' });
        await put.getByText('What was agreed stands until the firm agrees.').waitFor();
        await fitsItsWidth(other);
        assert.deepEqual(await findings(other), []);
        await other.screenshot({
          path: `${settings.artefacts}browser-firm-retime-phone.png`,
          fullPage: true,
        });
        await put.getByRole('button', { name: 'Agree to the new time' }).click();
        await put.waitFor({ state: 'detached' });
        await question.waitFor({ state: 'detached' });
        await page.getByTestId('call').waitFor({ state: 'detached' });
        const agreed = await good(page.request.get(`/api/v1/work-orders/${order}`));
        assert.equal(Date.parse(agreed.planned_at), day);
        assert.equal(agreed.fee_eur, 2100.5, 'the fee stands');
        assert.equal(agreed.call_fit, null);
      } finally {
        await theirs.close();
      }
      assert.deepEqual(faults, []);
      const why = { ...written, data: { text: 'A test' } };
      await good(page.request.post(`/api/v1/work-orders/${order}/cancel`, why));
    },
  },
};
