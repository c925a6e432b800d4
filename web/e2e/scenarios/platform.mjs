/** Who runs the platform: companies are entered, and work together. */
import assert from 'node:assert/strict';
import { fitsItsWidth, notSignedIn, signInAs } from '../helpers.mjs';

export const platform = {
  'who runs the platform enters an operator and a firm, and has them work together': {
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signInAs(page, settings.platform, settings.password, 'Platform');
      await page.getByText(/^Ready\./).waitFor();
      const operators = page.getByRole('region', { name: 'Operators' });
      await operators.getByRole('button', { name: 'Enter the operator' }).click();
      await operators.getByRole('alert').getByText('needs a name').waitFor();
      await operators.getByLabel('Name of the operator').fill('Armada del Sur');
      await operators.getByRole('button', { name: 'Enter the operator' }).click();
      await operators.getByText('Armada del Sur is entered').waitFor();
      const line = operators.getByRole('listitem').filter({ hasText: 'Armada del Sur' });
      await line.getByRole('button', { name: 'Invite an admin of Armada del Sur' }).click();
      await line.getByLabel('Name').fill('Elcano');
      await line.getByLabel('E-mail').fill('elcano@test.example');
      await line.getByRole('button', { name: 'Invite', exact: true }).click();
      assert.match(
        await line.getByTestId('invitation-link').innerText(),
        /\/invitation#[0-9A-Z-]{19}$/,
      );
      await line.getByRole('button', { name: 'Done' }).click();
      const firms = page.getByRole('region', { name: 'Adjuster firms' });
      await firms.getByLabel('Name of the firm').fill('Río Compass');
      await firms.getByRole('button', { name: 'Enter the firm' }).click();
      await firms.getByText('Río Compass is entered').waitFor();
      const together = page.getByRole('region', { name: 'Who works with whom' });
      await together.getByLabel('Operator').selectOption({ label: 'Armada del Sur' });
      await together.getByLabel('Firm').selectOption({ label: 'Río Compass' });
      await together.getByRole('button', { name: 'They work together' }).click();
      await together.getByText('Armada del Sur works with Río Compass.').waitFor();
      await together.getByRole('button', { name: 'They do so no more' }).click();
      await together.getByText('works with Río Compass no more').waitFor();
      await fitsItsWidth(page);
      await shoot('platform', { fullPage: true });
    },
  },
};
