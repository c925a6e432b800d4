/** What is between an operator and firms about an order: offers, answers, messages. */

import { translate } from './language';

export const offers = translate('offers', {
  title: 'Firms',
  lead: 'Who was asked to do it, and what they answered.',
  leadOfYours: 'What the operator asks of your firm.',
  none: 'It is offered to no firm. It can be done by the ship’s own people, or offered to firms that you work with.',
  toYou: 'From the operator',
  state: {
    waiting: 'its turn has not come',
    open: 'asked',
    proposed: 'proposes other terms',
    accepted: 'has it',
    declined: 'declined',
    lapsed: 'did not answer in time',
    withdrawn: 'withdrawn',
  } as Record<string, string>,
  ofYours: {
    open: 'it is offered to your firm',
    proposed: 'the operator has not answered yet what you proposed',
    accepted: 'your firm has it',
  } as Record<string, string>,
  answerBy: (when: string) => `answer due by ${when}`,
  terms: {
    when: 'When',
    berth: 'Berth',
    fee: 'Fee',
    euros: (fee: string) => `€ ${fee}`,
    offered: (fee: string) => `Offered at ${fee}, travel not counted`,
    team: (name: string) => `Team ${name}`,
  },

  call: {
    title: 'Port call',
    fit: {
      fits: 'The port call has moved, and the agreed time still lies in it.',
      other_hour:
        'The port call has moved: she is alongside on the agreed day, but not from that hour. Agree on another.',
      needs_new_day: 'The port call has moved: agree on a new day.',
      no_call:
        'The agreed time stands without a port call: agree on another time, or cancel the order.',
    },
    needs: {
      other_hour: 'Call moved: needs another hour',
      needs_new_day: 'Call moved: needs a new day',
      no_call: 'Port call gone',
    },
    was: 'It was',
    is: 'It is',
    agreed: 'Agreed',
    withdrawn: 'withdrawn',
    span: (port: string, from: string, to: string) => `${port}, from ${from} to ${to}`,
  },

  retime: {
    ask: 'Ask for another time…',
    submit: 'Ask the firm',
    asked: 'Another time is asked for',
    stands: 'What was agreed stands until the firm agrees.',
    agree: 'Agree to the new time',
    disagree: 'Keep what was agreed',
    takeBack: 'Take the question back',
  },

  offer: 'Offer it to firms…',
  submit: 'Offer it',
  which: 'Firms, in the order in which they are to be asked',
  order: (n: number, name: string) => `${n}. ${name}`,
  noFirms: 'Your company works with no firm here yet. Whoever runs this server enters firms.',
  firmsMissing: 'Choose a firm.',
  hours: 'Hours for an answer',
  hoursWrong: 'Say how many hours, 1 to 720.',
  atOnce: 'Ask all of them at once: the first to accept has it',
  say: 'What is said to them',

  agree: 'Agree',
  agreeTo: (firm: string) => `Agree to what ${firm} proposes`,
  disagree: 'Do not agree',
  disagreeTo: (firm: string) => `Do not agree to what ${firm} proposes`,
  word: 'A word to them',

  accept: 'Accept',
  adjuster: 'Who will come',
  licence: 'Licence number',
  adjusterMissing: 'Say who will come.',
  propose: 'Propose other terms…',
  proposeSubmit: 'Propose it',
  planned: 'From when instead',
  until: 'Until',
  portTime: 'port’s time',
  hoursMissing: 'Say from when to when: the end within 24 hours after the beginning.',
  berth: 'Berth, if another',
  fee: 'Fee in euros',
  feeWrong: 'A fee is a figure, 0 to 1 000 000.',
  termsMissing: 'Say another time, another berth or another fee.',
  decline: 'Decline…',
  declineConfirm: 'Decline it',
  giveBack: 'Give it back…',
  giveBackConfirm: 'Give it back',
  why: 'Why',
  whyMissing: 'Say why.',
  gone: 'It is no order of yours any more.',
});

export const messages = translate('messages', {
  title: 'Messages',
  lead: 'Between operator and firm; no other firm reads them.',
  none: 'Nothing was written yet.',
  nobody: 'Messages go to a firm that is asked or has the order.',
  by: (name: string, firm: string) => `${name}, ${firm}`,
  to: 'To',
  toFirm: (firm: string) => `to ${firm}`,
  label: 'Message',
  send: 'Send',
  sending: 'Sending…',
  missing: 'Write something first.',
});
