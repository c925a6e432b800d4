/** People and what acts for them: inviting, a second factor, tokens, enrolling, firms, an adjuster. */
import assert from 'node:assert/strict';
import {
  createHmac,
  createPrivateKey,
  createPublicKey,
  generateKeyPairSync,
  sign,
} from 'node:crypto';
import { readFile } from 'node:fs/promises';
import { encode } from 'uqr';
import { findings } from '../axe.mjs';
import {
  atAnyHour,
  fitsItsWidth,
  notSignedIn,
  openMenu,
  phone,
  signIn,
  struck,
} from '../helpers.mjs';

/** RFC 6238 with what authenticator apps use: SHA-1, 30 s, six digits. */
function codeNow(secret) {
  const bits = [...secret.replaceAll(/[\s=]/g, '')]
    .map((letter) =>
      'ABCDEFGHIJKLMNOPQRSTUVWXYZ234567'.indexOf(letter).toString(2).padStart(5, '0'),
    )
    .join('');
  const key = Buffer.from((bits.match(/.{8}/g) ?? []).map((octet) => parseInt(octet, 2)));
  const counter = Buffer.alloc(8);
  counter.writeBigUInt64BE(BigInt(Math.floor(Date.now() / 30_000)));
  const mac = createHmac('sha1', key).update(counter).digest();
  const at = mac[19] & 15;
  return String((mac.readUInt32BE(at) & 0x7fffffff) % 1_000_000).padStart(6, '0');
}

/** The picture's dark modules are those of `content`. */
async function saysQr(qr, content) {
  const drawn = await qr.locator('path').getAttribute('d');
  const { data } = encode(content, { ecc: 'M', border: 4 });
  const dark = data.flatMap((row, y) => row.flatMap((is, x) => (is ? [`M${x} ${y}h1v1h-1z`] : [])));
  assert.equal(drawn, dark.join(''));
}

const adjuster = (settings) => ({ email: settings.adjuster, password: settings.password });

async function signInAs(page, { email, password }, heading) {
  await page.goto('/');
  await page.getByLabel('E-mail').fill(email);
  await page.getByLabel('Password').fill(password);
  await page.getByRole('button', { name: 'Sign in' }).click();
  await page.getByRole('heading', { name: heading, level: 1 }).waitFor();
}

/** Waits in the page until the browser has an order, and the files of its page. */
async function untilKept(id) {
  const opened = await new Promise((done, fail) => {
    const opening = indexedDB.open('binnacle-orders');
    opening.onsuccess = () => done(opening.result);
    opening.onerror = () => fail(opening.error);
  });
  const keptOrder = () =>
    new Promise((done, fail) => {
      const asked = opened.transaction('orders').objectStore('orders').getKey(id);
      asked.onsuccess = () => done(asked.result === id);
      asked.onerror = () => fail(asked.error);
    });
  const keptPage = async () =>
    (await (await caches.open('binnacle-page-1')).keys()).some(({ url }) =>
      url.includes('/assets/WorkOrder-'),
    );
  const soon = Date.now() + 15_000;
  while (!((await keptOrder()) && (await keptPage()))) {
    if (Date.now() > soon) throw new Error('the order is not kept');
    await new Promise((drawn) => requestAnimationFrame(drawn));
  }
  opened.close();
}

export const people = {
  'someone is invited, sets a password, and sets up a second factor': {
    allowedErrors: [notSignedIn, /status of 422 .*\/me\/second-factor/],
    async run({ page, context, browser, settings, shoot }) {
      await signIn(page, settings);
      await page.getByRole('link', { name: 'Settings' }).click();
      await page.getByRole('link', { name: 'People' }).click();
      const email = `ada-${Date.now()}@test.example`;
      await page.getByRole('button', { name: 'Invite', exact: true }).click();
      await page.getByRole('alert').getByText('Enter a name').waitFor();
      await page.getByLabel('Name').fill('Ada Example');
      await page.getByLabel('E-mail').fill(email);
      await page.getByRole('button', { name: 'Invite', exact: true }).click();
      const code = await page.getByTestId('invitation-code').innerText();
      const link = await page.getByTestId('invitation-link').innerText();
      await saysQr(page.getByTestId('qr'), link);
      await page.getByTestId('users').getByText(email).waitFor();
      await shoot('people', { fullPage: true });

      const other = await browser.newContext({ baseURL: settings.url, viewport: phone });
      const theirs = await other.newPage();
      await theirs.goto('/invitation');
      await theirs.getByLabel('One-time code').fill(code);
      await theirs.getByLabel('New password').fill('gangway lantern 1867 brass');
      await theirs.getByRole('button', { name: 'Set password' }).click();
      await theirs.getByText(`Your password is set. Sign in as ${email}.`).waitFor();
      await signInAs(theirs, { email, password: 'gangway lantern 1867 brass' }, 'Fleet');
      await openMenu(theirs);
      await theirs.getByRole('link', { name: 'Settings', exact: true }).click();
      const factor = theirs.getByRole('region', { name: 'Second factor' });
      await factor.getByLabel('Your password').fill('gangway lantern 1867 brass');
      await factor.getByRole('button', { name: 'Set it up' }).click();
      const secret = await factor.getByTestId('secret').innerText();
      await factor.getByTestId('qr').waitFor();
      await fitsItsWidth(theirs);
      await shoot('second-factor-phone', {}, theirs);
      await factor.getByLabel('Code from the app').fill(codeNow(secret));
      await factor.getByRole('button', { name: 'Confirm' }).click();
      await factor.getByTestId('recovery-codes').waitFor();
      assert.ok((await factor.getByTestId('recovery-codes').locator('li').count()) >= 5);
      await factor.getByRole('button', { name: 'I have them' }).click();
      await factor.getByText('You have a second factor.').waitFor();
      await other.close();
      await context.clearCookies();
    },
  },

  'a token is made, shown once, and ended': {
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      await page.goto('/settings');
      const tokens = page.getByRole('region', { name: 'API tokens' });
      await tokens.getByLabel('What it is for').fill('Reports');
      await tokens.getByRole('button', { name: 'Make a token' }).click();
      const token = await tokens.getByTestId('token').innerText();
      const asked = await page.request.get('/api/v1/vessels', {
        headers: { Authorization: `Bearer ${token}`, Cookie: '' },
      });
      assert.equal(asked.status(), 200);
      await tokens.getByRole('button', { name: 'I have it' }).click();
      assert.equal(await tokens.getByText(token).count(), 0);
      await tokens.getByRole('button', { name: 'End the token “Reports”' }).click();
      await tokens.getByRole('button', { name: 'End', exact: true }).click();
      await tokens.getByText('You have none.').waitFor();
      await shoot('settings', { fullPage: true });
    },
  },

  'an agent is enrolled by the code in a QR code': {
    viewport: phone,
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      const vessel = await struck(page);
      await page.goto('/settings/agents');
      const uploads = page.getByTestId('uploads');
      await uploads
        .getByText(/ago$|just now/)
        .first()
        .waitFor();
      await fitsItsWidth(page);
      await uploads.getByRole('button', { name: vessel.name }).click();
      assert.equal(await page.getByLabel('Vessel').inputValue(), vessel.id);
      await page.getByRole('button', { name: 'Make a code' }).click();
      const code = await page.getByTestId('enrolment-code').innerText();
      const command = await page.locator('pre code').innerText();
      assert.ok(command.includes(code));
      await saysQr(page.getByTestId('qr'), command);
      await fitsItsWidth(page);
      await shoot('enrol-phone', { fullPage: true });
    },
  },

  'a firm’s terms are said and changed': {
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      await page.getByRole('link', { name: 'Firms' }).click();
      const firm = page.getByRole('region', { name: 'Maas Compass' });
      await firm.getByRole('button', { name: /^(Add|Change) terms$/ }).click();
      await firm.getByLabel('Fee for a job, €').fill('2100');
      await firm.getByLabel(/^Ports/).fill('Rotterdam');
      await firm.getByRole('button', { name: 'Save the terms' }).click();
      await firm.getByRole('alert').getByText('Line 1 of the ports').waitFor();
      await firm.getByLabel(/^Ports/).fill('NLRTM 150\nBEANR 400');
      await firm.getByLabel(/^Begins at/).fill('8');
      await firm.getByLabel('Ends at').fill('18');
      await firm.getByLabel('Saturday').check();
      await firm.getByLabel('Sunday').uncheck();
      await firm.getByRole('button', { name: 'Save the terms' }).click();
      const ports = 'Rotterdam (NLRTM), € 150 travel; Antwerpen (BEANR), € 400 travel';
      await firm.getByText(ports).waitFor();
      await firm.getByText(/Friday, Saturday, 08:00 to 18:00/).waitFor();
      await fitsItsWidth(page);
      await shoot('firms', { fullPage: true });
    },
  },

  'who did what is found in the audit log, by deed and by day': {
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      await page.getByRole('link', { name: 'Settings' }).click();
      await page.getByRole('link', { name: 'Audit log' }).click();
      const lines = page.getByTestId('audit').locator('tbody tr');
      await lines.first().waitFor();
      await page.getByRole('combobox', { name: 'What' }).selectOption('Signed in · Signed out');
      await page.getByRole('button', { name: 'Show', exact: true }).click();
      await lines
        .filter({ hasNotText: /Signed (in|out)/ })
        .first()
        .waitFor({ state: 'detached' });
      await lines.filter({ hasText: 'Signed in' }).filter({ hasText: 'done' }).first().waitFor();
      const csv = page.getByRole('link', { name: 'Download as CSV' });
      const answer = await page.request.get(await csv.getAttribute('href'));
      const file = (await answer.text()).trim().split('\n');
      assert.ok(file.length > 1 && file.slice(1).every((line) => line.includes('/api/v1/session')));
      await shoot('audit', { fullPage: true });

      await page.getByLabel(/^From/).fill('2099-01-02');
      await page.getByLabel('To, with that day').fill('2099-01-01');
      await page.getByRole('button', { name: 'Show', exact: true }).click();
      await page.getByRole('alert').getByText('after the last').waitFor();
      await page.getByLabel('To, with that day').fill('2099-01-02');
      await page.getByRole('button', { name: 'Show', exact: true }).click();
      await page.getByText('Nothing noted is like that').waitFor();
      await page.getByRole('button', { name: 'Show everything' }).click();
      await lines.first().waitFor();
      await page.setViewportSize(phone);
      await fitsItsWidth(page);
      await shoot('audit-phone');
    },
  },

  'a firm has a key made, registers another by its proof, and revokes one': {
    allowedErrors: [notSignedIn, /status of 422 .*\/keys\b/],
    async run({ page, browser, settings, shoot }) {
      await signInAs(page, adjuster(settings), 'My orders');
      await page.getByRole('link', { name: 'Settings' }).click();
      await page.getByRole('link', { name: 'Signing keys' }).click();
      await page.getByText('None is registered').waitFor();
      const listed = page.getByTestId('signing-keys').getByRole('listitem');
      const { firm_id: firm } = await (await page.request.get('/api/v1/me')).json();
      const said = Buffer.from(`binnacle firm key ${firm}`);

      await page.getByRole('button', { name: 'Register a key' }).click();
      await page.getByRole('button', { name: 'Register it' }).click();
      await page.getByRole('alert').filter({ hasText: 'Give the key a name' }).waitFor();
      await page.getByLabel('Name').fill('Office, 2026');
      await page.getByRole('button', { name: 'Make a key' }).click();
      await page.getByText('A key was made').waitFor();
      const publicKey = await page.getByLabel('Public key').inputValue();
      await page.getByRole('button', { name: 'Register it' }).click();
      await page.getByRole('alert').filter({ hasText: 'Save the private key first' }).waitFor();
      await shoot('signing-key-made', { fullPage: true });
      const [download] = await Promise.all([
        page.waitForEvent('download'),
        page.getByRole('link', { name: 'Save the private key' }).click(),
      ]);
      const pem = await readFile(await download.path(), 'utf8');
      const held = createPublicKey(createPrivateKey(pem));
      const raw = held.export({ format: 'der', type: 'spki' }).subarray(-32).toString('hex');
      assert.equal(raw, publicKey, 'the file is the key’s that is shown');
      await page.getByRole('button', { name: 'Register it' }).click();
      await listed.filter({ hasText: 'Office, 2026' }).getByText(publicKey).waitFor();

      const own = generateKeyPairSync('ed25519');
      const of = own.publicKey.export({ format: 'der', type: 'spki' }).subarray(-32);
      await page.getByRole('button', { name: 'Register a key' }).click();
      await page.getByLabel('Name').fill('Laptop');
      await page.getByText('Its public half and proof').press('Enter');
      await page.getByLabel('Public key').fill(of.toString('hex'));
      const proof = page.getByLabel('Proof');
      await proof.fill('12');
      await page.getByRole('button', { name: 'Register it' }).click();
      await page.getByRole('alert').filter({ hasText: 'not 128 hexadecimal' }).waitFor();
      await proof.fill(sign(null, Buffer.from('something else'), own.privateKey).toString('hex'));
      await page.getByRole('button', { name: 'Register it' }).click();
      await page.getByRole('alert').filter({ hasText: 'is not this key' }).waitFor();
      await proof.fill(sign(null, said, own.privateKey).toString('hex'));
      await page.getByRole('button', { name: 'Register it' }).click();
      await listed.filter({ hasText: 'Laptop' }).waitFor();

      await page.getByRole('button', { name: 'Revoke Laptop' }).click();
      await page.getByRole('button', { name: 'Revoke it' }).click();
      await listed
        .filter({ hasText: 'Laptop' })
        .getByText(/^revoked /)
        .waitFor();
      assert.equal(await page.getByRole('button', { name: 'Revoke Laptop' }).count(), 0);
      assert.deepEqual(await findings(page), []);
      await shoot('signing-keys', { fullPage: true });
      await page.setViewportSize(phone);
      await fitsItsWidth(page);
      await shoot('signing-keys-phone', { fullPage: true });

      const office = await browser.newContext({ baseURL: settings.url });
      const theirs = await office.newPage();
      await signIn(theirs, settings);
      await theirs.goto('/firms');
      await theirs.getByText(publicKey).waitFor();
      await office.close();
    },
  },

  'an adjuster signs in on a phone and finds today’s ship': {
    viewport: phone,
    // Her binnacle was not entered; and without a connection every call fails.
    allowedErrors: [notSignedIn, /ERR_INTERNET_DISCONNECTED/],
    async run({ page, context, browser, settings, shoot }) {
      const office = await browser.newContext({ baseURL: settings.url });
      const theirs = await office.newPage();
      await signIn(theirs, settings);
      const vessel = await struck(theirs);
      const headers = { 'X-Binnacle-Request': '1' };
      const { items: firms } = await (await theirs.request.get('/api/v1/firms')).json();
      const firm = firms.find(({ name }) => name === 'Ibaizabal Compass');
      const ports = [{ port: 'NLRTM', travel_eur: 100 }];
      const terms = { fee_eur: 1800, ports, ...atAnyHour };
      const said = await theirs.request.put(`/api/v1/firms/${firm.id}/terms`, {
        headers,
        data: terms,
      });
      assert.ok(said.ok(), await said.text());
      const before = await (
        await theirs.request.get(`/api/v1/work-orders?vessel=${vessel.id}`)
      ).json();
      for (const { id, state } of before.items) {
        if (['closed', 'cancelled'].includes(state)) continue;
        const data = { text: 'Made anew' };
        await theirs.request.post(`/api/v1/work-orders/${id}/cancel`, { headers, data });
      }
      const made = await theirs.request.post('/api/v1/work-orders', {
        headers,
        data: {
          vessel_id: vessel.id,
          compass_id: vessel.compasses[0].id,
          port: 'Bilbao (ESBIO)',
          planned_at: new Date().toISOString(),
          offer: { firms: [firm.id], answer_within_hours: 24 },
        },
      });
      assert.equal(made.status(), 201, await made.text());
      const { id } = await made.json();

      await signInAs(page, adjuster(settings), 'My orders');
      await page.getByRole('heading', { name: 'Waiting for an answer' }).waitFor();
      const asked = page.getByRole('region', { name: 'Waiting for an answer' });
      await asked.getByRole('link', { name: vessel.name }).waitFor();
      const taken = await page.request.post(`/api/v1/work-orders/${id}/accept`, {
        headers,
        data: { adjuster_name: 'R. Sáez', adjuster_licence: 'ES-CA-114' },
      });
      assert.ok(taken.ok(), await taken.text());
      const today = page.getByRole('region', { name: 'Today’s ships' });
      await today.getByText(/UTC[^·]* · \d+ \w+, \d\d:\d\d by this device’s clock/).waitFor();
      await fitsItsWidth(page);
      await shoot('home-phone', { fullPage: true });
      const way = today.getByRole('link', { name: 'Go to the binnacle' });
      assert.equal(await way.getAttribute('href'), `/work-orders/${id}`);

      // It is kept before anybody looks at it: on the quay there is no connection.
      await page.evaluate(untilKept, id);
      await context.setOffline(true);
      await page.reload();
      await page.getByText('These orders are kept on this device').waitFor();
      await today.getByText(/^Kept on this device as it was on \d+ \w+, \d\d:\d\d$/).waitFor();
      await fitsItsWidth(page);
      await shoot('home-offline-phone', { fullPage: true });
      await way.click();
      await page.getByRole('heading', { name: `${vessel.name}: adjustment`, level: 1 }).waitFor();
      await page.getByRole('button', { name: 'I am on board' }).click();
      await page.getByRole('heading', { name: 'Read the field' }).waitFor();
      await shoot('home-offline-step-phone');
      await page.goBack();
      await today.getByText('1 thing is waiting to be sent').waitFor();
      await today.getByText('Adjuster on board', { exact: true }).waitFor();
      await context.setOffline(false);
      await page.getByText('These orders are kept on this device').waitFor({ state: 'detached' });
      await today.getByRole('link', { name: vessel.name }).waitFor();
      for (const path of ['/alerts', `/vessels/${vessel.id}`]) {
        await page.goto(path);
        await page.getByRole('heading', { name: 'This page is the operator’s' }).waitFor();
      }
      await page.getByRole('link', { name: 'To my orders' }).click();
      await page.getByRole('heading', { name: 'My orders', level: 1 }).waitFor();
      await office.close();
    },
  },
};
