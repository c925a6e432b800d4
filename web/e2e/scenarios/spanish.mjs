/** The dashboard for who reads Spanish. */
import assert from 'node:assert/strict';
import { findings } from '../axe.mjs';
import { fitsItsWidth, fleetIsShown, notSignedIn, struck } from '../helpers.mjs';

/** A vessel that has no order yet, by the API. */
async function enterVessel(page) {
  const answer = await page.request.post('/api/v1/vessels', {
    headers: { 'X-Binnacle-Request': '1' },
    data: { name: 'Ría de Bilbao' },
  });
  assert.ok(answer.ok(), await answer.text());
  return answer.json();
}

export const spanish = {
  'who reads Spanish sees what changed, and orders an adjustment': {
    locale: 'es-ES',
    // The vessel that was entered just now has no model.
    allowedErrors: [notSignedIn, /status of 404 .*\/(model|deviation|binnacle)\b/],
    async run({ page, settings, shoot }) {
      await page.goto('/');
      await page.getByLabel('Correo electrónico').fill(settings.email);
      await page.getByLabel('Contraseña').fill(settings.password);
      await page.getByRole('button', { name: 'Iniciar sesión' }).click();
      await page.getByRole('heading', { name: 'Flota', level: 1 }).waitFor();
      assert.equal(await page.getAttribute('html', 'lang'), 'es');
      await fleetIsShown(page);
      await page.getByText('En directo', { exact: true }).waitFor();
      await page.getByRole('columnheader', { name: 'Mayor desvío' }).waitFor();
      assert.deepEqual(await findings(page), []);
      await fitsItsWidth(page);
      await shoot('spanish-fleet', { fullPage: true });

      const vessel = await struck(page);
      await page.getByRole('rowheader').getByRole('link', { name: vessel.name }).click();
      await page.getByRole('heading', { name: vessel.name, level: 1 }).waitFor();
      const tabs = page.getByRole('navigation', { name: 'Sobre el buque' });
      await tabs.getByRole('link', { name: 'Cambios', exact: true }).click();
      const changes = page.getByRole('region', { name: 'Qué ha cambiado' });
      const change = changes.getByRole('listitem').filter({ hasText: 'Rayo o golpe' }).first();
      await change.waitFor();
      const said = await change.innerText();
      assert.match(said, /\d{1,2} [a-z]{3} 20\d\d, \d\d:\d\d UTC/);
      assert.match(
        said,
        /Mayor cambio del desvío, donde estaba entonces el buque\s+cambió \d+,\d°/,
      );
      assert.match(said, /cambió [+−]\d,\d ± \d,\d\sµT/);
      await fitsItsWidth(page);
      await shoot('spanish-changes', {}, changes);

      const { id, name } = await enterVessel(page);
      await page.goto(`/vessels/${id}/adjustment`);
      const orders = page.getByRole('region', { name: 'Compensación' });
      await orders.getByRole('link', { name: 'Encargar una compensación' }).click();
      await page.getByRole('heading', { name: 'Encargar una compensación', level: 1 }).waitFor();
      await page.getByText('su bitácora, con los correctores a bordo').waitFor();
      const order = page.getByRole('button', { name: 'Encargar', exact: true });
      await order.click();
      await page.getByRole('alert').getByText('Indicar en qué puerto.').waitFor();
      await page.getByLabel('Puerto').fill('ESBIO');
      const tomorrow = new Date(Date.now() + 86_400_000).toISOString().slice(0, 16);
      await page.getByLabel('Cuándo (UTC)').fill(tomorrow);
      const who = page.getByRole('group', { name: 'Quién compensa' });
      await who.getByRole('radio', { name: 'Otra persona, por su nombre' }).check();
      await page.getByLabel('Compensador').fill('M. Etxeberria');
      await shoot('spanish-order', { fullPage: true });
      await order.click();
      await page.getByRole('heading', { name: `${name}: compensación`, level: 1 }).waitFor();
      await page.getByText('Prevista', { exact: true }).first().waitFor();
    },
  },

  'another language is chosen in the settings, and kept': {
    locale: 'es-ES',
    allowedErrors: [notSignedIn],
    async run({ page, settings }) {
      await page.goto('/');
      await page.getByLabel('Correo electrónico').fill(settings.email);
      await page.getByLabel('Contraseña').fill(settings.password);
      await page.getByRole('button', { name: 'Iniciar sesión' }).click();
      await page.getByRole('heading', { name: 'Flota', level: 1 }).waitFor();
      await page.goto('/settings');
      const choice = page.getByRole('group', { name: 'Idioma del panel' });
      assert.ok(await choice.getByRole('radio', { name: 'Español' }).isChecked());
      // Not check(): the page is loaded anew before that could look.
      await choice.getByText('English').click();
      await page.getByRole('group', { name: 'Language of the dashboard' }).waitFor();
      assert.equal(await page.getAttribute('html', 'lang'), 'en');
      await page.goto('/');
      await page.getByRole('heading', { name: 'Fleet', level: 1 }).waitFor();
    },
  },
};
