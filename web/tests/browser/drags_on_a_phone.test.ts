import { describeDrags } from './drags';

describeDrags({ phone: true });
