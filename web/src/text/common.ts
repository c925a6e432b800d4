/** What every page shows, and the way in. */

import { onCatalogue, translate } from './language';

export let product = 'Binnacle';
export let tagline = 'The magnetic compass, corrected at sea';
export let noMountPoint = 'index.html has no element with the id "app"';

export let skip = 'Skip to content';
export let loading = 'Loading…';
export let retry = 'Try again';
export let chartNotLoaded = 'The drawing could not be loaded. Its figures stand in the table.';
export let cancel = 'Cancel';
export let copy = 'Copy';
export let copied = 'Copied';
export let showMore = (n: number) => `Show ${n} more`;
export let optional = 'optional';
export let unfinished = 'Finish this, or clear it.';
export let utc = 'UTC';
/** On paper: of when it is. */
export let asOf = (when: string) => `As of ${when}`;

export let signOut = 'Sign out';

export const signIn = translate('signIn', {
  title: 'Sign in',
  email: 'E-mail',
  password: 'Password',
  submit: 'Sign in',
  busy: 'Signing in…',
  wrong: 'E-mail or password is wrong.',
  missing: 'Enter e-mail and password.',
  code: 'Code',
  codeHelp: 'From your authenticator app; or one of your recovery codes.',
  codeWrong: 'The code is wrong, or was used before.',
  codeMissing: 'Enter the code.',
  otherUser: 'Sign in as someone else',
  or: 'or',
  by: (provider: string) => `Sign in with ${provider}`,
  /** Why nobody was signed in by the provider, by the word in the address. */
  why: {
    cancelled: 'The sign-in was given up, or you were not let in there.',
    over: 'That sign-in took too long, was begun in another browser, or was finished before. Try again.',
    unreachable: 'The sign-in service cannot be reached just now. Try again, or use your password.',
    untrusted:
      'What the sign-in service said does not hold. Try again; if it stays so, tell your admin.',
    unverified: 'The sign-in service does not vouch for an e-mail address of yours.',
    unknown:
      'Nobody with your e-mail address may sign in here. Ask your admin to invite you under that address.',
    taken:
      'Your e-mail address belongs here to another person of the sign-in service. Ask whoever runs this server.',
    throttled: 'Too many attempts failed. Wait a little, then try again.',
    failed: 'Something went wrong here. Try again.',
  } as Record<string, string>,
});

export const invitation = translate('invitation', {
  title: 'Set your password',
  help: 'At least 12 characters: a few words that belong together only to you are easy to keep.',
  code: 'One-time code',
  password: 'New password',
  submit: 'Set password',
  busy: 'Setting…',
  missing: 'Enter the code and a password.',
  unknown: 'This code is not known, or was used. Ask your admin for another.',
  done: (email: string) => `Your password is set. Sign in as ${email}.`,
});

export const theme = translate('theme', {
  label: 'Colours',
  auto: 'Auto',
  light: 'Day',
  dark: 'Night',
});

export const live = translate('live', {
  connecting: 'Connecting',
  live: 'Live',
  lost: 'Not live',
  liveLong: 'Shows new data as it arrives',
  lostLong: 'The live connection is lost; trying again',
  /** Said on the page when it lasts. */
  without: (since: string) =>
    `Not connected since ${since}. What you see is of then or before, and what you change may not get through. It is brought up to date as soon as the connection is back.`,
});

export const problem = translate('problem', {
  offline: 'The server cannot be reached. Check the connection.',
  offlineNothing:
    'The server cannot be reached, and nothing of this is kept here. It comes as soon as the connection is back.',
  offlineStale: (since: string) =>
    `The server cannot be reached. What you see is from ${since}; it is refreshed as soon as the connection is back.`,
  stale: (since: string, detail: string) =>
    `This could not be refreshed (${detail}). What you see is from ${since}.`,
  unexpected: (status: number) => `The server answered with an error (${status}).`,
  unreadable: 'The server answered in a form that this page cannot read.',
  superseded:
    'This was built upon something that did not hold. Look at what is to be done now, and do it anew.',
  signedOut: 'Your session has ended. Sign in again.',
  notFoundTitle: 'Nothing here',
  notFound: 'There is no such page, or it belongs to another fleet.',
  toVessels: 'To the fleet',
  ofOperatorTitle: 'This page is the operator’s',
  ofOperator:
    'Vessels, alerts and the schedule are for the people of the fleet. What your firm is asked for and has agreed to stands with your orders.',
  toOrders: 'To my orders',
  title: 'This could not be shown',
});

export const document = translate('document', {
  fleet: 'Fleet · Binnacle',
  vessel: (name: string) => `${name} · Binnacle`,
  signIn: 'Sign in · Binnacle',
  firstRun: 'Set up · Binnacle',
  start: 'Getting started · Binnacle',
  invitation: 'Set your password · Binnacle',
  notFound: 'Nothing here · Binnacle',
  alerts: 'Alerts · Binnacle',
  mail: 'Mail · Binnacle',
  webhooks: 'Webhooks · Binnacle',
  orders: 'Work orders · Binnacle',
  schedule: 'Schedule · Binnacle',
  binnacles: 'Binnacles · Binnacle',
  firms: 'Firms · Binnacle',
  home: 'My orders · Binnacle',
  platform: 'Platform · Binnacle',
  reports: 'Reports · Binnacle',
  notifications: 'Notifications · Binnacle',
  settings: 'Settings · Binnacle',
  help: 'Help · Binnacle',
  people: 'People · Binnacle',
  aboard: 'Agents · Binnacle',
  audit: 'Audit log · Binnacle',
  scheduleRules: 'Schedule rules · Binnacle',
  newOrder: 'Order an adjustment · Binnacle',
  order: (vessel: string) => `Adjustment of ${vessel} · Binnacle`,
});

/** What the pages are called that the bar on top leads to. */
export const pages = translate('pages', {
  label: 'Pages',
  fleet: 'Fleet',
  alerts: 'Alerts',
  unacknowledged: ' alerts that nobody has acknowledged',
  schedule: 'Schedule',
  reports: 'Reports',
  notifications: 'Notifications',
  unread: ' unread',
  orders: 'Work orders',
  binnacles: 'Binnacles',
  firms: 'Firms',
  home: 'My orders',
  platform: 'Platform',
  settings: 'Settings',
  help: 'Help',
  menu: 'Menu',
  yourAccount: 'Your settings',
});

onCatalogue((catalogue) => {
  ({
    product,
    tagline,
    noMountPoint,
    skip,
    loading,
    retry,
    chartNotLoaded,
    cancel,
    copy,
    copied,
    showMore,
    optional,
    unfinished,
    utc,
    asOf,
    signOut,
  } = catalogue);
});
