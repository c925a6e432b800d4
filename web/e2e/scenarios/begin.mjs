/** A company begins: from an empty server to vessels, firms and a last adjustment. */
import assert from 'node:assert/strict';
import { fitsItsWidth, notSignedIn, phone } from '../helpers.mjs';

const password = 'seven gulls over the quay';

async function setUp({ page, settings, shoot }) {
  await page.goto(settings.emptyUrl);
  await page.getByRole('heading', { name: 'Set up this server' }).waitFor();
  await page.getByRole('button', { name: 'Create company and account' }).click();
  await page.getByRole('alert').getByText('Fill in every field.').waitFor();
  await page.getByLabel('Set-up code').fill('AAAA-AAAA-AAAA-AAAA');
  await page.getByLabel('Company').fill('Armada del Sur');
  await page.getByLabel('Your name').fill('Ada Lovelace');
  await page.getByLabel('E-mail').fill('ada@test.example');
  await page.getByLabel('Password').fill(password);
  await page.getByRole('button', { name: 'Create company and account' }).click();
  await page.getByRole('alert').getByText('This code is not known').waitFor();
  await shoot('first-run');
  await page.getByLabel('Set-up code').fill(settings.setupCode);
  await page.getByRole('button', { name: 'Create company and account' }).click();
  await page.getByRole('heading', { name: 'Getting started', level: 1 }).waitFor();
}

async function signInThere(page, settings) {
  await page.goto(settings.emptyUrl);
  await page.getByLabel('E-mail').fill('ada@test.example');
  await page.getByLabel('Password').fill(password);
  await page.getByRole('button', { name: 'Sign in' }).click();
  await page.getByRole('heading', { name: 'Fleet', level: 1 }).waitFor();
}

const file = (text) => ({ name: 'v.csv', mimeType: 'text/csv', buffer: Buffer.from(text) });

export const begin = {
  'an empty server makes the company, and leads on to its vessels': {
    allowedErrors: [notSignedIn, /status of 404 .*first-run/, /status of 422 .*vessels\.csv/],
    hosts: ({ emptyUrl }) => [emptyUrl],
    async run(given) {
      const { page, shoot } = given;
      await setUp(given);
      await page.getByText('Add your first vessel above.').waitFor();
      await page.getByLabel('File, .csv').setInputFiles(file('name,imo_number\nNao,123\n'));
      await page.getByRole('button', { name: 'Add the vessels' }).click();
      await page.getByRole('alert').getByText('line 2: imo_number: 123 is not').waitFor();
      const two = 'name,imo_number,flag\nNao Victoria,9074729,ES\nKogge,,DE\n';
      await page.getByLabel('File, .csv').setInputFiles(file(two));
      await page.getByRole('button', { name: 'Add the vessels' }).click();
      await page.getByText('2 vessels are added.').waitFor();
      const row = page
        .getByTestId('checklist')
        .getByRole('row')
        .filter({ hasText: 'Nao Victoria' });
      await row.getByText('Not known', { exact: true }).waitFor();
      await row.getByRole('button', { name: 'Record the date' }).click();
      await row.getByLabel('Day on which Nao Victoria was last adjusted').fill('2025-03-01');
      await row.getByRole('button', { name: 'Record the date', exact: true }).click();
      await row.getByText('1 Mar 2025').waitFor();
      await row.getByRole('link', { name: 'No data yet: see the agent' }).waitFor();
      await shoot('getting-started', { fullPage: true });
      await page.goto('about:blank');
      await page.goto(given.settings.emptyUrl);
      await page.getByRole('link', { name: 'Getting started: 2 vessels are not live' }).waitFor();
      const kogge = page.getByRole('row').filter({ hasText: 'Kogge' });
      await kogge.getByRole('link', { name: 'no adjustment on record' }).waitFor();
      assert.equal(await page.getByText('Overdue').count(), 0);
      await shoot('first-morning');
    },
  },

  'a company adds a firm of its own and invites its adjuster, on a phone too': {
    viewport: phone,
    allowedErrors: [notSignedIn],
    hosts: ({ emptyUrl }) => [emptyUrl],
    async run({ page, settings, shoot }) {
      await signInThere(page, settings);
      await page.goto(`${settings.emptyUrl}/firms`);
      await page.getByText('Add a firm, or ask').waitFor();
      await page.getByLabel('Name of the firm').fill('Nervión Compass');
      await page.getByRole('button', { name: 'Add the firm' }).click();
      await page.getByText('Nervión Compass is added.').waitFor();
      await page.getByRole('button', { name: 'Invite an adjuster' }).click();
      await page.getByLabel('Name', { exact: true }).fill('Rosa Sáez');
      await page.getByLabel('E-mail').fill('rosa@test.example');
      await page.getByRole('button', { name: 'Invite', exact: true }).click();
      await page.getByTestId('invitation-code').waitFor();
      await fitsItsWidth(page);
      await shoot('own-firm-phone', { fullPage: true });
    },
  },

  'a forgotten password is asked for on the way in': {
    allowedErrors: [notSignedIn],
    async run({ page }) {
      await page.goto('/');
      await page.getByRole('button', { name: 'Forgot your password?' }).click();
      await page.getByRole('button', { name: 'Send the link' }).click();
      await page.getByRole('alert').getByText('Enter your e-mail address.').waitFor();
      await page.getByLabel('E-mail').fill('nobody@test.example');
      await page.getByRole('button', { name: 'Send the link' }).click();
      await page.getByText('If nobody@test.example has an account here').waitFor();
      await page.getByRole('button', { name: 'Back to sign-in' }).click();
      await page.getByLabel('Password').waitFor();
    },
  },
};
