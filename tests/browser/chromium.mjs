/** Chromium as all browser tests and measurements use it. */

import { chromium } from 'playwright-core';

import { findChromium } from './hosts.mjs';

/** Starts Chromium. It draws without a graphics card, so that the pictures of all computers are alike. */
export const launch = () => chromium.launch({
  executablePath: findChromium(),
  args: ['--no-sandbox', '--disable-gpu', '--disable-background-networking',
    '--disable-features=LocalNetworkAccessChecks,LocalNetworkAccessChecksWebSockets,PrivateNetworkAccessChecks'],
});
