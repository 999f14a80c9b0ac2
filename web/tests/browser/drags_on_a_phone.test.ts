// SPDX-License-Identifier: Apache-2.0
import { describeDrags } from './drags';

describeDrags({ phone: true });
