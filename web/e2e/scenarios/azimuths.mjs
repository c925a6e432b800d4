/** Azimuths: the compass error by the sun and by a transit. */
import assert from 'node:assert/strict';
import { fitsItsWidth, notSignedIn, openTab, openVessel, signIn } from '../helpers.mjs';

export const azimuths = {
  'an azimuth shows its errors at once, stands in the book, and is withdrawn': {
    // Values that the server questions.
    allowedErrors: [notSignedIn, /status of 422 .*\/azimuths/],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      await openVessel(page);
      await openTab(page, 'Deviation');
      const panel = page.getByRole('region', { name: 'Azimuths' });
      await panel.getByText('No azimuth has been entered yet').waitFor();

      await panel.getByRole('button', { name: 'Enter an azimuth' }).click();
      await panel.getByLabel('Compass heading').fill('092.0');
      const time = panel.getByLabel(/^Time, to the second/);
      await time.fill('2026-05-09T10:00:07');
      await panel.getByLabel('Latitude').fill('43 24.0 N');
      await panel.getByLabel('Longitude').fill('095 W');
      await panel.getByLabel('Observer’s initials').fill('LW');
      await panel.getByRole('button', { name: 'Find the error' }).click();
      await panel.getByRole('alert').filter({ hasText: 'Bearing by compass' }).waitFor();
      await panel.getByLabel('Bearing by compass').and(page.locator(':focus')).waitFor();
      await panel.getByLabel('Bearing by compass').fill('120');
      await panel.getByRole('button', { name: 'Find the error' }).click();
      // It is night there: the longitude was meant to be 3° W.
      await panel.getByRole('alert').filter({ hasText: 'below the horizon' }).waitFor();
      await shoot('azimuth-refused', {}, panel);
      await panel.getByLabel('Longitude').fill('003 06.0 W');
      await panel.getByLabel('Bearing by compass').fill('020');
      await panel.getByRole('button', { name: 'Find the error' }).click();
      await panel.getByRole('alert').filter({ hasText: 'deviation of' }).waitFor();
      await panel.getByLabel('It was observed so').waitFor();
      await panel.getByLabel('Bearing by compass').fill('129.5');
      await panel.getByLabel('Gyro heading').fill('094');
      await panel.getByRole('button', { name: 'Find the error' }).click();
      const said = panel.getByRole('status').filter({ hasText: 'The azimuth has been entered' });
      await said.waitFor();
      assert.match(
        await said.innerText(),
        /Compass error \d+\.\d°( [EW])? · deviation .* · gyro error .* · true bearing \d{3}\.\d°/,
      );
      const listed = panel.getByRole('listitem').filter({ hasText: 'Sun, by azimuth' });
      await listed.getByText('Observed by LW, entered by Test Officer.').waitFor();

      await panel.getByRole('button', { name: 'Enter an azimuth' }).click();
      await panel.getByRole('combobox', { name: /^Bearing of/ }).selectOption('transit');
      assert.equal(await panel.getByLabel('Altitude').count(), 0);
      await panel.getByLabel('Compass heading').fill('092.0');
      await panel.getByLabel(/^Name/).fill('Leading lights');
      await time.fill('2026-05-09T12:00:00');
      await panel.getByLabel('True bearing').fill('131');
      await panel.getByLabel('Bearing by compass').fill('131');
      await panel.getByLabel('Observer’s initials').fill('LW');
      await panel.getByRole('button', { name: 'Find the error' }).click();
      await panel.getByRole('alert').filter({ hasText: 'to the last digit' }).waitFor();
      await shoot('azimuth-asked', {}, panel);
      await panel.getByLabel('It was observed so').check();
      await panel.getByRole('button', { name: 'Find the error' }).click();
      await panel.getByText('Transit, Leading lights').waitFor();

      const book = await page.evaluate(async () => {
        const vessel = /\/vessels\/([^/?]+)/.exec(location.href)[1];
        const response = await fetch(`/api/v1/vessels/${vessel}/deviation-book.csv`);
        return response.text();
      });
      assert.equal(book.split('\n').filter((line) => line.includes(',LW,')).length, 2);

      await panel.getByRole('button', { name: /^Withdraw: Transit/ }).click();
      await panel.getByLabel('Why').fill('The wrong lights');
      await panel.getByRole('button', { name: 'Withdraw the azimuth' }).click();
      await panel.locator('s', { hasText: 'Leading lights' }).waitFor();
      await panel.getByText(/Withdrawn by Test Officer/).waitFor();
      await fitsItsWidth(page);
      await shoot('azimuths', {}, panel);
    },
  },
};
