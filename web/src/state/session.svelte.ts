/** Who is signed in. `unknown` until the server has been asked. */

import { findMe, sendProviderCode, signIn, signOut, whenSignedOut } from '../api/client';
import { Problem } from '../api/problem';
import type { Me } from '../api/types';
import { forgetMe, keepMe, keptMe } from './me';

type Session =
  | { status: 'unknown' }
  | { status: 'failed'; problem: Problem }
  | { status: 'out'; ended: boolean }
  | { status: 'in'; me: Me };

class SessionState {
  current = $state<Session>({ status: 'unknown' });

  get me(): Me | null {
    return this.current.status === 'in' ? this.current.me : null;
  }

  get isAdmin(): boolean {
    return this.me?.role === 'admin';
  }

  /** Whether the reader is of a firm that adjusts compasses. */
  get isAdjuster(): boolean {
    return this.me?.role === 'adjuster';
  }

  /** Whether the reader runs the platform: then there is neither fleet nor orders. */
  get isPlatformAdmin(): boolean {
    return this.me?.role === 'platform_admin';
  }

  /** Whether the reader may work at the binnacle: the ship's own people, or a firm's. */
  get mayAdjust(): boolean {
    return this.isAdmin || this.isAdjuster;
  }

  /** Whether nothing may be done before a second factor is set up. */
  get lacksSecondFactor(): boolean {
    return this.me !== null && this.me.second_factor_required && !this.me.second_factor;
  }

  async find(): Promise<void> {
    try {
      this.#begin(await findMe());
    } catch (error) {
      if (!(error instanceof Problem)) throw error;
      // Without a connection whoever was signed in goes on with what the browser keeps;
      // the server itself gives nothing without the session.
      const kept = error.offline ? keptMe() : null;
      if (kept) {
        this.current = { status: 'in', me: kept };
        return;
      }
      if (error.status === 401) forgetMe();
      this.current =
        error.status === 401
          ? { status: 'out', ended: false }
          : { status: 'failed', problem: error };
    }
  }

  async signIn(email: string, password: string, code?: string): Promise<void> {
    this.#begin(await signIn(email, password, code));
  }

  /** The last step of who came back from the provider and has a second factor. */
  async sendProviderCode(code: string): Promise<void> {
    this.#begin(await sendProviderCode(code));
  }

  async signOut(): Promise<void> {
    await signOut().catch((error: unknown) => {
      // A session that has already ended is signed out all the same.
      if (!(error instanceof Problem && error.status === 401)) throw error;
    });
    forgetMe();
    this.current = { status: 'out', ended: false };
  }

  ended(): void {
    if (this.current.status === 'in') this.current = { status: 'out', ended: true };
  }

  #begin(me: Me): void {
    keepMe(me);
    this.current = { status: 'in', me };
  }
}

export const session = new SessionState();
whenSignedOut(() => {
  session.ended();
});
