import { describeDrags } from './drags';

describeDrags('a screen of 1280 px', false);
