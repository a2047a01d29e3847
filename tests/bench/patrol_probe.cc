#include <cstdlib>
#include <iostream>
#include "core/common/angle.h"
#include <cmath>
#include "tests/bench/virtual_site.h"
#include "tests/support/process.h"
using namespace cairn; using namespace cairn::bench;
int main(int argc,char**argv){
  cairn::test::TempFolder folder;
  VirtualSite::Config c; c.world = argc>1?argv[1]:"room"; c.seed= argc>2?std::atoi(argv[2]):1;
  c.radio={.rate_bit_s=64000,.queue=std::chrono::seconds(4),.delay=std::chrono::milliseconds(300)};
  const int minutes = argc>3?std::atoi(argv[3]):8;
  if(argc>4) c.max_speed_m_s=std::atof(argv[4]);
  VirtualSite site(c, folder.path());
  auto places=std::vector<Eigen::Vector2d>{{10.5,2.5},{10.5,10.5},{2.5,10.5},{2.5,2.5}};
  if(argc>5){places.clear(); for(int i=5;i+1<argc;i+=2) places.push_back({std::atof(argv[i]),std::atof(argv[i+1])});}
  site.patrol(places);
  double worst=0,sum=0;int n=0;
  for(int i=0;i<minutes*2;++i){
    if(i==2*(std::getenv("RESTART")?std::atoi(std::getenv("RESTART")):1000)){site.restart_agent();site.run(std::chrono::milliseconds(20)); worst=sum=0;n=0;std::cout<<"restart\n";}
    auto b=site.bytes(); auto k=site.agent().link().budget().sent_bytes(); auto kd=site.server().link()?site.server().link()->budget().sent_bytes():proto::TrafficBytes{};
    auto f=site.agent().link().counters().frames_sent; 
    for(int s=0;s<60;++s){site.run(std::chrono::milliseconds(500)); auto t=site.truth().T_site_robot; auto p=site.agent().mapper().pose(); double e=std::hypot(t.x_m-p.x_m,t.y_m-p.y_m); if(i>3){worst=std::max(worst,e);sum+=e;++n;}}
    auto b2=site.bytes(); auto k2=site.agent().link().budget().sent_bytes(); auto kd2=site.server().link()->budget().sent_bytes();
    auto q=[](auto x,auto y){return static_cast<double>(x-y)*8.0/30;};
    std::cout<<int(site.agent().mapper().localization())<<" "<<i*30<<"s up "<<q(b2.up,b.up)<<" down "<<q(b2.down,b.down)<<" | up ctl "<<q(k2[0],k[0])<<" pose "<<q(k2[1],k[1])<<" map "<<q(k2[2],k[2])<<" frames "<<site.agent().link().counters().frames_sent-f<<" | down ctl "<<q(kd2[0],kd[0])<<" pose "<<q(kd2[1],kd[1])<<" map "<<q(kd2[2],kd[2])<<" rounds "<<site.rounds()<<" dist "<<site.agent().mapper().distance_m()<<" err mean "<<(n?sum/n:0)<<" worst "<<worst<<" sub "<<site.agent().mapper().replica().submaps()<<"\n"<<std::flush;
  }
}
