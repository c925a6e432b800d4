/** The first run of a server, and what a company does until its vessels are live. */

import { translate } from './language';

export const firstRun = translate('firstRun', {
  title: 'Set up this server',
  tagline: 'It has no user yet. Create your company and your account.',
  code: 'Set-up code',
  codeHelp: 'On the server, binnacle-server admin first-run prints it. It is valid for a day.',
  company: 'Company',
  name: 'Your name',
  email: 'E-mail',
  password: 'Password',
  submit: 'Create company and account',
  busy: 'Creating…',
  missing: 'Fill in every field.',
  unknown: 'This code is not known. Print another on the server.',
  made: (email: string) => `Your company is made, with the account ${email}.`,
  notSignedIn: (why: string) => `Signing in failed: ${why}`,
  demo: 'To look around first, make demo runs a fleet of simulated vessels beside this server.',
});

export const forgotten = translate('forgotten', {
  open: 'Forgot your password?',
  lead: 'We send you a link with which you set a new password. It is valid for an hour.',
  submit: 'Send the link',
  busy: 'Sending…',
  sent: (email: string) =>
    `If ${email} has an account here, an e-mail is on its way. Check your inbox.`,
  missing: 'Enter your e-mail address.',
  back: 'Back to sign-in',
});

export const start = translate('start', {
  title: 'Getting started',
  link: (n: number) =>
    n === 1
      ? 'Getting started: 1 vessel is not live'
      : `Getting started: ${n} vessels are not live`,
  lead: 'What a vessel needs until its deviation is measured and its adjustments are planned.',
  vessels: 'Vessels',
  add: 'Add a vessel',
  file: 'Add vessels from a file',
  fileLead:
    'A CSV file whose first line names the columns: name, imo_number, call_sign, flag. Only the name is needed.',
  which: 'File, .csv',
  sample: 'Download a sample file',
  send: 'Add the vessels',
  sending: 'Adding…',
  fileMissing: 'Choose a file.',
  added: (n: number) => (n === 1 ? '1 vessel is added.' : `${n} vessels are added.`),
  duplicates: (number: string, names: string) =>
    `IMO number ${number} is entered for several vessels: ${names}. Correct all but one, or take them out of service.`,
  none: 'Add your first vessel above.',
  next: 'Then',
  firms: 'Add the firms that adjust your compasses',
  calls: 'Enter port calls, or send a file of them',
  people: 'Invite your colleagues',
  checklist: 'Checklist',
  vessel: 'Vessel',
  step: {
    agent: 'Agent',
    model: 'Model',
    adjusted: 'Last adjusted on',
    call: 'Port calls',
    particulars: 'Particulars',
  },
  todo: {
    agent: 'No data yet: see the agent',
    model: 'Waiting for samples',
    adjusted: 'Not known',
    compass: 'No compass',
    notAsked: 'Not known yet',
    call: 'Enter port calls',
    particulars: (missing: number) =>
      missing === 1 ? 'Complete 1 fact' : `Complete ${missing} facts`,
  },
  done: { agent: 'sends', model: 'measured', call: 'entered', particulars: 'complete' },
  live: 'live',
  record: 'Record the date',
  recording: 'Recording…',
  day: (vessel: string) => `Day on which ${vessel} was last adjusted`,
  dayMissing: 'Choose a day.',
});
