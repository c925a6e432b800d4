/** Coming in, going out, and what lies between. */
import assert from 'node:assert/strict';
import { findings } from '../axe.mjs';
import {
  fitsItsWidth,
  notSignedIn,
  openMenu,
  openTab,
  openVessel,
  phone,
  signIn,
  withModel,
} from '../helpers.mjs';

export const session = {
  'a wrong password is refused in words': {
    allowedErrors: [notSignedIn, /status of 401 .*\/api\/v1\/session\b/],
    async run({ page, settings, shoot }) {
      await page.goto('/');
      await page.getByLabel('E-mail').fill(settings.email);
      await page.getByLabel('Password').fill(`${settings.password}-not`);
      await page.getByRole('button', { name: 'Sign in' }).click();
      await page.getByRole('alert').filter({ hasText: 'E-mail or password is wrong' }).waitFor();
      assert.equal(await page.getByLabel('Password').inputValue(), '');
      await shoot('wrong-password');
    },
  },

  'the keyboard alone reaches a vessel, and back': {
    allowedErrors: [notSignedIn],
    async run({ page, settings }) {
      await page.goto('/');
      await page.getByLabel('E-mail').focus();
      await page.keyboard.type(settings.email);
      await page.keyboard.press('Tab');
      await page.keyboard.type(settings.password);
      await page.keyboard.press('Enter');
      await page.getByRole('heading', { name: 'Fleet', level: 1 }).waitFor();
      const link = page.getByRole('rowheader').getByRole('link').first();
      await link.waitFor();
      for (let presses = 0; presses < 45; presses++) {
        if (await link.evaluate((element) => element === document.activeElement)) break;
        await page.keyboard.press('Tab');
      }
      await page.keyboard.press('Enter');
      await page.waitForURL(/\/vessels\//);
      await page.goBack();
      await page.getByRole('heading', { name: 'Fleet', level: 1 }).waitFor();
    },
  },

  'who goes from page to page is asked for, and told what happens, once': {
    allowedErrors: [notSignedIn],
    async run({ page, settings }) {
      await signIn(page, settings);
      await page.goto('/');
      await page.getByRole('heading', { name: 'Fleet', level: 1 }).waitFor();
      await page.getByText('Live', { exact: true }).waitFor();
      const asked = [];
      page.on('request', (request) => asked.push(new URL(request.url()).pathname));
      for (const name of ['Schedule', 'Reports', 'Alerts', 'Fleet']) {
        await page.getByRole('banner').getByRole('link', { name }).click();
        await page.getByRole('heading', { name, level: 1 }).waitFor();
      }
      await page.waitForLoadState('networkidle');
      const again = asked.filter((path) => /\/(me|events|alerts|notifications)$/.test(path));
      // The page of the alerts asks for those that were cleared lately.
      assert.deepEqual(again, ['/api/v1/alerts']);
    },
  },

  'an address of nobody shows nothing': {
    allowedErrors: [notSignedIn, /status of 404 .*\/api\/v1\/vessels\//],
    async run({ page, settings }) {
      await signIn(page, settings);
      await page.goto('/vessels/01900000-0000-7000-8000-000000000000');
      await page.getByRole('heading', { name: 'Nothing here' }).waitFor();
    },
  },

  'losing the server is said, and its return is noticed': {
    allowedErrors: [notSignedIn, /ERR_INTERNET_DISCONNECTED/],
    async run({ page, context, settings }) {
      await signIn(page, settings);
      await openVessel(page);
      await openTab(page, 'Deviation');
      await context.setOffline(true);
      await page.getByRole('button', { name: 'Choose another place' }).click();
      await page.getByRole('button', { name: 'Show', exact: true }).click();
      // What was not there yet says so too.
      const said = page.getByText('The server cannot be reached').first();
      await said.waitFor();
      await context.setOffline(false);
      await said.waitFor({ state: 'detached' });
    },
  },

  'a person signs in by the word of a provider, and one whom nobody knows does not': {
    // The page is left and come back to: the service worker takes over between.
    allowedErrors: [notSignedIn, /cross-world service worker resource mismatch/],
    hosts: ({ issuer, publicUrl }) => [issuer, publicUrl],
    async run({ page, settings, shoot }) {
      // The name that the server has for the world leads to where it listens here.
      await page.route(`${settings.publicUrl}/**`, (route) => {
        const { pathname, search } = new URL(route.request().url());
        const location = `${settings.url}${pathname}${search}`;
        return route.fulfill({ status: 302, headers: { location } });
      });
      await page.goto('/');
      const begin = page.getByRole('link', { name: 'Sign in with Test Lines' });
      await begin.waitFor();
      await shoot('sign-in-provider');
      await begin.click();
      await page.getByRole('link', { name: 'Continue as nobody@test.example' }).click();
      const unknown = page.getByRole('alert').getByText('Nobody with your e-mail address');
      await unknown.waitFor();
      await begin.click();
      await page.getByRole('link', { name: `Continue as ${settings.email}` }).click();
      await page.getByRole('heading', { name: 'Fleet', level: 1 }).waitFor();
      const { items } = await (await page.request.get('/api/v1/sessions')).json();
      assert.ok(items.some(({ provider }) => provider === 'Test Lines'));
      const me = await (await page.request.get('/api/v1/me')).json();
      assert.equal(me.email, settings.email);
      await openMenu(page);
      await page.getByRole('button', { name: 'Sign out' }).click();
      await page.getByRole('button', { name: 'Sign in' }).waitFor();
    },
  },

  'the lamp is not that of a live page before it is one': {
    allowedErrors: [notSignedIn],
    async run({ page, settings }) {
      const colour = () =>
        page.locator('header .lamp').evaluate((lamp) => getComputedStyle(lamp).backgroundColor);
      let open = () => undefined;
      await page.route('**/api/v1/events**', async (route) => {
        await new Promise((done) => (open = done));
        await route.continue();
      });
      await signIn(page, settings);
      const banner = page.getByRole('banner');
      await banner.getByText('Connecting', { exact: true }).waitFor();
      const before = await colour();
      open();
      await banner.getByText('Live', { exact: true }).waitFor();
      assert.notEqual(before, await colour());
    },
  },

  'a vessel, a tab of it, a setting and a passage of the help are found by keys': {
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      const { id, name } = await withModel(page);
      await page.getByRole('rowheader').first().waitFor();
      const box = page.getByRole('combobox', { name: 'Vessel, port, work order' });
      const seek = async (key, sought) => {
        await page.keyboard.press(key);
        await box.and(page.locator(':focus')).waitFor();
        await page.keyboard.type(sought);
      };
      await seek('/', name.toUpperCase());
      const options = page.getByRole('listbox', { name: 'Found' }).getByRole('option');
      await options.filter({ hasText: `${name}: Changes` }).waitFor();
      await shoot('finder');
      assert.deepEqual(await findings(page), []);
      await page.keyboard.press('Enter');
      await page.getByRole('heading', { name, level: 1 }).waitFor();
      await seek('Control+k', `${name} chang`);
      await options.first().getByText(`${name}: Changes`).waitFor();
      await page.keyboard.press('Enter');
      await page.waitForURL(`**/vessels/${id}/changes`);
      await seek('Control+k', 'no such thing');
      await page.getByText('Nothing is called “no such thing”.').waitFor();
      await page.keyboard.press('Escape');
      await page.locator('dialog').waitFor({ state: 'detached' });
      await seek('Control+k', 'help');
      await page.keyboard.press('Enter');
      await page.getByRole('heading', { name: 'Help', level: 1 }).waitFor();
      await page.getByLabel('Search the help').fill('uncertain card');
      await page
        .getByRole('link', { name: /^Deviation card and deviation book/ })
        .last()
        .click();
      await page.getByRole('heading', { name: /^Deviation card/, level: 1 }).waitFor();
      await shoot('help', { fullPage: true });
      assert.deepEqual(await findings(page), []);
      await page.setViewportSize(phone);
      await fitsItsWidth(page);
    },
  },

  'a phone has one line of header, and the rest in a menu': {
    viewport: phone,
    allowedErrors: [notSignedIn],
    async run({ page, settings, shoot }) {
      await signIn(page, settings);
      const header = page.getByRole('banner');
      assert.ok((await header.boundingBox()).height < 64, 'the header is one line');
      assert.equal(await header.getByRole('link', { name: 'Schedule' }).count(), 0);
      await openMenu(page);
      await shoot('menu-phone');
      assert.deepEqual(await findings(page), []);
      await header.getByRole('link', { name: 'Schedule' }).click();
      await page.getByRole('heading', { name: 'Schedule', level: 1 }).waitFor();
      assert.ok((await header.boundingBox()).height < 64, 'the menu closes');
      await openMenu(page);
      await page.keyboard.press('Escape');
      await header.getByRole('link', { name: 'Schedule' }).waitFor({ state: 'detached' });
    },
  },

  'the help leads to what is found in the topic that is open': {
    allowedErrors: [notSignedIn],
    async run({ page, settings }) {
      await signIn(page, settings);
      await page.goto('/help/alerts');
      const section = page.getByRole('article').getByRole('heading').last();
      const title = await section.innerText();
      const found = page.getByRole('link', { name: `: ${title}` });
      // Twice: the second time the address has it already.
      for (let time = 0; time < 2; time++) {
        await page.getByLabel('Search the help').fill(title);
        await found.first().click();
        await section.waitFor();
        assert.equal(await page.getByLabel('Search the help').inputValue(), '');
      }
    },
  },

  'signing out ends the session': {
    allowedErrors: [notSignedIn],
    async run({ page, settings }) {
      await signIn(page, settings);
      await openMenu(page);
      await page.getByRole('button', { name: 'Sign out' }).click();
      await page.getByRole('button', { name: 'Sign in' }).waitFor();
      await page.goto('/');
      await page.getByRole('button', { name: 'Sign in' }).waitFor();
    },
  },
};
